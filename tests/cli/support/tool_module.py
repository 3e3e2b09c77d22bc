"""Programs of tools/ that are written in Python, as modules."""
import importlib.machinery
import importlib.util
import sys
from pathlib import Path


def tool_module(source, name):
    """Returns the program tools/NAME of a source tree as a module, without running it."""
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader(name.replace("-", "_"), str(Path(source) / "tools" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module
