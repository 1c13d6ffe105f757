"""The pose graph: links between nodes, their optimisation, and the test that loops must pass."""

from slam.graph.graph import PoseGraph
from slam.graph.optimizer import Optimized, optimize
from slam.graph.verify import Closure, WorstLink, close_loops, max_error

__all__ = ["Closure", "Optimized", "PoseGraph", "WorstLink", "close_loops", "max_error", "optimize"]
