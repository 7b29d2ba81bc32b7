# SPDX-License-Identifier: Apache-2.0
from .video import Film

__all__ = ["Film"]
