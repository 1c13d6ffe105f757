"""Reading maps for the page: from a map file to the shapes of the API."""
