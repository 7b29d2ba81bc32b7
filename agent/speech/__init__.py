"""Speech in and out: sounds, recognisers, what they heard together, and voices."""
