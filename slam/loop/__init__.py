"""Loop closure: which known place this is, and whether the images agree."""
