"""A rendered walk through a furnished flat, with exact truth: input that needs no download."""
