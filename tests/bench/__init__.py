"""Timings of the engine and of starting it; never a gate."""
