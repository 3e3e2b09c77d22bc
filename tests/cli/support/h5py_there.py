"""h5py with the filter that reads shards of --codec lz4. Tests that import this module are skipped without them."""
import sys

try:
    import h5py
    import numpy
except ImportError as error:
    print(f"skipped: {error} (python3-h5py)")
    sys.exit(77)
if not h5py.h5z.filter_avail(32004):
    print("skipped: HDF5's LZ4 filter is not installed (hdf5-filter-plugin)")
    sys.exit(77)
