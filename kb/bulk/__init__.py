"""Imports and exports of any size: rules and statements as streams of text."""
