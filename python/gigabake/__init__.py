"""Reads the scenes that gigabake bakes as numpy arrays, and runs the program."""
from .errors import GigabakeError, IncompleteWarning
from .program import bake, plan, profile, query, query_array, volume
from .scene import Level, Scene, open
from .voxels import Voxels

__all__ = ["GigabakeError", "IncompleteWarning", "Level", "Scene", "Voxels", "bake", "open", "plan", "profile", "query",
           "query_array", "volume"]
__version__ = "0.3.0"
