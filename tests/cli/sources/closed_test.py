#!/usr/bin/env python3
"""Checks that text in a source file causes no network access and opens no file outside the source.

Usage: closed_test.py GIGABAKE SOURCE_DIR

A listening socket also serves as the proxy of every protocol. The access time of a file next to the source's folder
shows whether the file was opened.
"""
import json
import os
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

GRID = "ncols 20\nnrows 20\nxllcorner 500000\nyllcorner 5100000\ncellsize 10\n" + ("1 2 3 4 " * 5 + "\n") * 20
DEGREES = "ncols 20\nnrows 20\nxllcorner 8\nyllcorner 46\ncellsize 0.001\n" + ("1 2 3 4 " * 5 + "\n") * 20
WGS84 = ('GEOGCS["x",DATUM["x",SPHEROID["WGS 84",6378137,298.257223563]{more}],PRIMEM["Greenwich",0],'
         'UNIT["degree",0.0174532925199433]{end}]')
GEOID = ('COMPD_CS["c",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
         'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]],VERT_CS["v",'
         'VERT_DATUM["v",2005,EXTENSION["PROJ4_GRIDS","{file}"]],UNIT["metre",1],AXIS["Up",UP]]]')
JSON_BOUND = json.dumps({
    "type": "BoundCRS", "source_crs": {"type": "GeographicCRS", "name": "w", "datum": {
        "type": "GeodeticReferenceFrame", "name": "w", "ellipsoid": {
            "name": "w", "semi_major_axis": 6378137, "inverse_flattening": 298.257223563}},
        "coordinate_system": {"subtype": "ellipsoidal", "axis": [
            {"name": "Longitude", "abbreviation": "lon", "direction": "east", "unit": "degree"},
            {"name": "Latitude", "abbreviation": "lat", "direction": "north", "unit": "degree"}]}},
    "target_crs": {"type": "GeographicCRS", "name": "WGS 84", "id": {"authority": "EPSG", "code": 4326},
                   "datum": {"type": "GeodeticReferenceFrame", "name": "World Geodetic System 1984", "ellipsoid": {
                       "name": "WGS 84", "semi_major_axis": 6378137, "inverse_flattening": 298.257223563}},
                   "coordinate_system": {"subtype": "ellipsoidal", "axis": [
                       {"name": "Latitude", "abbreviation": "lat", "direction": "north", "unit": "degree"},
                       {"name": "Longitude", "abbreviation": "lon", "direction": "east", "unit": "degree"}]}},
    "transformation": {"name": "t", "method": {"name": "NTv2", "id": {"authority": "EPSG", "code": 9615}},
                       "parameters": [{"name": "Latitude and longitude difference file", "value": "FILE",
                                       "id": {"authority": "EPSG", "code": 8656}}]}})
BOUND = ('BOUNDCRS[SOURCECRS[GEOGCRS["x",DATUM["x",ELLIPSOID["WGS 84",6378137,298.257223563]],CS[ellipsoidal,2],'
         'AXIS["lat",north],AXIS["lon",east],ANGLEUNIT["degree",0.0174532925199433]]],'
         'TARGETCRS[GEOGCRS["WGS 84",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]],'
         'CS[ellipsoidal,2],AXIS["lat",north],AXIS["lon",east],ANGLEUNIT["degree",0.0174532925199433]]],'
         'ABRIDGEDTRANSFORMATION["t",METHOD["NTv2",ID["EPSG",9615]],'
         'PARAMETERFILE["Latitude and longitude difference file","{file}",ID["EPSG",8656]]]]')


class Listener:
    """A socket that accepts every connection and records that there was one."""

    def __init__(self):
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.address = f"127.0.0.1:{self.socket.getsockname()[1]}"

    def had_visitor(self):
        try:
            self.socket.accept()[0].close()
            return True
        except BlockingIOError:
            return False


class ClosedTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name) / "source"
        self.root.mkdir()
        self.canary = Path(self.folder.name) / "canary.gsb"
        self.canary.write_bytes(b"NUM_OREC" + b"\0" * 2000)
        self.listener = Listener()
        self.rearm()
        if not self.is_seen(lambda: self.canary.read_bytes()):
            self.skipTest("the file system keeps no times of access")

    def tearDown(self):
        self.listener.socket.close()
        self.folder.cleanup()

    def rearm(self):
        os.utime(self.canary, ns=(1_000_000_000, 2_000_000_000))  # an access time before the change is always updated

    def is_seen(self, work):
        self.rearm()
        work()
        return self.canary.stat().st_atime_ns != 1_000_000_000

    def plan(self, source, *arguments):
        proxy = "http://" + self.listener.address
        environment = {**os.environ, **harness.MPI_ENVIRONMENT, "PROJ_NETWORK": "ON", "http_proxy": proxy,
                       "https_proxy": proxy, "all_proxy": proxy, "PROJ_NETWORK_ENDPOINT": proxy}
        return subprocess.run([PROGRAM.executable, "plan", str(source), "--voxel-size", "10", *arguments], text=True,
                              capture_output=True, timeout=60, env=environment, check=False)

    def expect_closed(self, source, what):
        results = []
        self.assertFalse(self.is_seen(lambda: results.append(self.plan(source))), f"{what}: opens the file")
        self.assertFalse(self.listener.had_visitor(), f"{what}: reaches the network")
        lines = results[0].stdout.splitlines() + results[0].stderr.splitlines()
        self.assertLessEqual(max(map(len, lines), default=0), 300)
        return results[0]

    def addresses(self):
        return [f"http://{self.listener.address}/x", f"/vsicurl/http://{self.listener.address}/x", str(self.canary),
                "../canary.gsb"]

    def scene(self, **entry):
        path = self.root / "scene.json"
        path.write_text(json.dumps({"gigabake": 1, "sources": [entry]}))
        return path

    # Regression of 2026-11-22: "crs" accessed the network and opened any file.
    def test_crs_of_a_scene(self):
        (self.root / "d.asc").write_text(DEGREES)
        targets = self.addresses()
        texts = targets + [f"DICT:{self.canary},1", f"+init={self.canary}:1", f"file://{self.canary}",
                           f"+proj=longlat +ellps=WGS84 +geoidgrids={self.canary} +type=crs",
                           f"ftp://{self.listener.address}/x"]
        for t in targets[::2]:
            texts += [f"+proj=longlat +ellps=WGS84 +nadgrids={t} +type=crs", f"proj=longlat ellps=WGS84 nadgrids={t}",
                      WGS84.format(more="", end=f',EXTENSION["PROJ4","+proj=longlat +ellps=WGS84 +nadgrids={t}"]'),
                      GEOID.format(file=t), JSON_BOUND.replace("FILE", t),
                      JSON_BOUND.replace("FILE", t).replace('"value"', '"\\u0076alue"'),
                      BOUND.format(file=t), f"+proj=pipeline +step +proj=hgridshift +grids={t}"]
        for text in texts:
            result = self.expect_closed(self.scene(dem="d.asc", crs=text), text)
            self.assertEqual(result.returncode, 1, f"{text}: {result.stderr}")
            self.assertIn("crs", result.stderr)

    def test_crs_that_names_nothing_is_read(self):
        (self.root / "d.asc").write_text(DEGREES)
        for text in ("EPSG:4326", "OGC:CRS84", "+proj=longlat +datum=WGS84 +no_defs", "+proj=longlat +ellps=WGS84 "
                     "+towgs84=1,2,3 +type=crs", WGS84.format(more="", end=""),
                     WGS84.format(more=",TOWGS84[1,2,3,0,0,0,0]", end=""), "EPSG:4314",
                     "+proj=longlat +ellps=WGS84 +nadgrids=@null +type=crs", GEOID.format(file="egm96_15.gtx")):
            result = self.expect_closed(self.scene(dem="d.asc", crs=text), text)
            self.assertEqual(result.returncode, 0, f"{text}: {result.stderr}")

    # Regression of 2026-11-22: a raster's own coordinate system had the same effect.
    def test_crs_of_a_raster_itself(self):
        (self.root / "d.asc").write_text(DEGREES)
        for t in self.addresses()[::2]:
            for text in (WGS84.format(more="", end=f',EXTENSION["PROJ4","+proj=longlat +ellps=WGS84 +nadgrids={t}"]'),
                         GEOID.format(file=t), BOUND.format(file=t)):
                (self.root / "d.prj").write_text(text)
                self.expect_closed(self.scene(dem="d.asc"), text)

    def test_files_beside_a_raster(self):
        """GDAL looks for masks and overviews in the folder of a raster, and opens them in any format."""
        (self.root / "d.asc").write_text(GRID)
        for address in self.addresses()[1:3]:
            virtual = ('<VRTDataset rasterXSize="20" rasterYSize="20"><VRTRasterBand dataType="Byte" band="1">'
                       f'<SimpleSource><SourceFilename>{address}</SourceFilename><SourceBand>1</SourceBand>'
                       '</SimpleSource></VRTRasterBand></VRTDataset>')
            service = (f'<GDAL_WMS><Service name="TMS"><ServerUrl>{address}</ServerUrl></Service><DataWindow>'
                       '<SizeX>20</SizeX><SizeY>20</SizeY></DataWindow></GDAL_WMS>')
            for content in (virtual, service) if address.startswith("/vsi") else (virtual,):
                for name in ("d.asc.msk", "d.asc.ovr", "d.asc.aux.xml", "d.asc.vrt"):
                    (self.root / name).write_text(content)
                self.expect_closed(self.scene(dem="d.asc", ortho="d.asc", crs="EPSG:25832"), content)
            (self.root / "d.vrt").write_text(virtual)
            self.expect_closed(self.scene(dem="d.vrt", crs="EPSG:25832"), virtual)

    def test_uris(self):
        meshes = self.root / "meshes"
        meshes.mkdir()
        for address in [*self.addresses(), f"file://{self.canary}"]:
            document = {"asset": {"version": "2.0"}, "buffers": [{"uri": address, "byteLength": 36}],
                        "images": [{"uri": address}], "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                        "bufferViews": [{"buffer": 0, "byteLength": 36}],
                        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}
            mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"
            (meshes / "a.gltf").write_text(json.dumps(document))
            (meshes / "a.obj").write_text(f"mtllib {address}\n{mesh}")
            (meshes / "b.obj").write_text(f"mtllib b.mtl\n{mesh}")
            (meshes / "b.mtl").write_text(f"newmtl m\nmap_Kd {address}\nmap_d {address}\n")
            self.assertNotEqual(self.expect_closed(meshes, f"meshes with {address}").returncode, 0)
            tile = {"geometricError": 1, "boundingVolume": {"sphere": [0, 0, 0, 9]}, "refine": "ADD"}
            implicit = {"subdivisionScheme": "QUADTREE", "subtreeLevels": 2, "availableLevels": 2,
                        "subtrees": {"uri": address}}
            roots = {"content": {**tile, "content": {"uri": address}}, "subtree": {**tile, "implicitTiling": implicit}}
            for name, root in roots.items():
                source = self.root / "tileset.json"
                source.write_text(json.dumps({"asset": {"version": "1.1"}, "geometricError": 1, "root": root}))
                self.assertNotEqual(self.expect_closed(source, f"{name} at {address}").returncode, 0)
            self.assertEqual(self.expect_closed(self.scene(path=address), f"path {address}").returncode, 1)

    def test_entities_of_a_scene_xml(self):
        secret = self.root / "secret.txt"
        secret.write_text("canary")
        for entity in (f'SYSTEM "file://{secret}"', f'SYSTEM "http://{self.listener.address}/x"', '"canary"'):
            scene = self.root / "scene.xml"
            scene.write_text(f'<?xml version="1.0"?><!DOCTYPE s [<!ENTITY e {entity}>]>'
                             '<OctTreeGroup Version="1" Generator="&e;" VoxelSize="&e;"/>')
            result = PROGRAM.run("info", scene)
            self.assertEqual(result.returncode, 1)
            self.assertNotIn("canary", result.stdout + result.stderr)
            self.assertFalse(self.listener.had_visitor())


class ShardTest(unittest.TestCase):
    """Checks that HDF5 does not follow links and external file lists in a shard."""

    def setUp(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("expected python3-h5py to be installed")
        self.h5py = h5py
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        harness.write_glb(self.root / "a.glb", [[0, 0, 0], [9, 0, 0], [9, 0, -9]], [0, 1, 2])
        PROGRAM.bake(self.root / "a.glb", self.root / "out", 1)
        self.shard = next((self.root / "out").rglob("*.h5"))
        self.other = self.root / "other.h5"
        self.other.write_bytes(self.shard.read_bytes())

    def tearDown(self):
        self.folder.cleanup()

    def expect_refusal(self):
        result = PROGRAM.run("verify", self.root / "out/scene.xml")
        self.assertNotEqual(result.returncode, 0)
        self.assertLessEqual(max(map(len, result.stderr.splitlines() + result.stdout.splitlines())), 300)
        export = PROGRAM.run("export", self.root / "out/scene.xml", "--to", "ply", "-o", self.root / "v.ply")
        self.assertNotEqual(export.returncode, 0)

    def test_external_link(self):
        with self.h5py.File(self.shard, "r+") as file:
            del file["lod_0"]
            file["lod_0"] = self.h5py.ExternalLink(str(self.other), "/lod_0")
        self.expect_refusal()

    def test_external_storage(self):
        with self.h5py.File(self.shard, "r+") as file:
            shape, kind = file["lod_0/alpha"].shape, file["lod_0/alpha"].dtype
            del file["lod_0/alpha"]
            file.create_dataset("lod_0/alpha", shape, kind, external=[(str(self.other), 0, self.h5py.h5f.UNLIMITED)])
        self.expect_refusal()

    def test_virtual_dataset(self):
        with self.h5py.File(self.shard, "r+") as file:
            shape, kind = file["lod_0/alpha"].shape, file["lod_0/alpha"].dtype
            del file["lod_0/alpha"]
            layout = self.h5py.VirtualLayout(shape, kind)
            layout[:] = self.h5py.VirtualSource(str(self.other), "lod_0/alpha", shape=shape)
            file.create_virtual_dataset("lod_0/alpha", layout)
        self.expect_refusal()


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:], verbosity=2)
