"""Links by hand, links in bulk, nodes: what people do to a map beyond saying which loops are true."""
