"""What is drawn from the graph: floor plans and point clouds. Import the modules: each loads only what it needs."""
