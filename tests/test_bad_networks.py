"""An invalid network file is refused by one line that names it, whatever its parser says."""

import io
import struct
import zipfile
from typing import Any

import numpy as np
import pytest
from onnx import TensorProto, helper, numpy_helper
from refused import Desk
from scipy.io import savemat
from scipy.sparse import csc_matrix

from tb.common.cases import random_mlp

MLP = random_mlp((3, 5, 2), 1.0, 1)
ROWS = {"w1": MLP.w1, "b1": MLP.b1, "w2": MLP.w2, "b2": MLP.b2}
COLUMNS = {"w1": MLP.w1.T, "b1": MLP.b1[None], "w2": MLP.w2.T, "b2": MLP.b2[None]}
NONE = {"w1": np.zeros((0, 3)), "b1": np.zeros(0), "w2": np.zeros((2, 0)), "b2": MLP.b2}


def npz(**changed: Any) -> bytes:
    file = io.BytesIO()
    np.savez(file, **{k: v for k, v in (ROWS | changed).items() if v is not None})
    return file.getvalue()


def npy(header: str, data: bytes = b"") -> bytes:
    """An archive of one array with a header of its own."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        start = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header))
        archive.writestr("w1.npy", start + header.encode() + data)
    return file.getvalue()


def shaped(shape: str) -> str:
    return f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}"


def zipped(offset: int, value: int) -> bytes:
    """An archive with a wrong field in its first entry: 0 for its flags, 2 for its method."""
    content = bytearray(npz())
    content[content.find(b"PK\x03\x04") + 6 + offset] = value
    content[content.find(b"PK\x01\x02") + 8 + offset] = value
    return bytes(content)


def damaged(content: bytes, at: int, count: int = 4) -> bytes:
    return content[:at] + bytes(b ^ 255 for b in content[at : at + count]) + content[at + count :]


def mat(variables: dict[str, Any], **options: Any) -> bytes:
    file = io.BytesIO()
    savemat(file, variables, **options)
    return file.getvalue()


def netlab(**changed: Any) -> bytes:
    return mat({"net": {k: v for k, v in (COLUMNS | changed).items() if v is not None}})


def onnx(**changed: Any) -> bytes:
    """A network in which some constants are replaced."""
    ends = [[helper.make_tensor_value_info(n, TensorProto.DOUBLE, [None, 3])] for n in "xy"]
    constants = COLUMNS | {"b1": MLP.b1, "b2": MLP.b2} | changed
    tensors = [
        value if isinstance(value, TensorProto) else numpy_helper.from_array(np.array(value), name)
        for name, value in constants.items()
    ]
    steps = [
        helper.make_node("MatMul", ["x", "w1"], ["a"]),
        helper.make_node("Add", ["a", "b1"], ["b"]),
        helper.make_node("Tanh", ["b"], ["c"]),
        helper.make_node("MatMul", ["c", "w2"], ["d"]),
        helper.make_node("Add", ["b2", "d"], ["y"]),
    ]
    return helper.make_model(helper.make_graph(steps, "test", *ends, tensors)).SerializeToString()


def tensor(**fields: Any) -> TensorProto:
    """The weights of layer 1 with some fields changed, or removed if the value is None."""
    made = numpy_helper.from_array(MLP.w1.T, "w1")
    for name, value in fields.items():
        made.ClearField(name)
        if name == "dims":
            made.dims.extend(value)
        elif value is not None:
            setattr(made, name, value)
    return made


def elsewhere(location: str) -> TensorProto:
    """The weights of layer 1 in another file."""
    made = tensor(raw_data=None, data_location=TensorProto.EXTERNAL)
    made.external_data.add(key="location", value=location)
    return made


NPZ = {
    "empty": (b"", "no zip archive"),
    "its end cut off": (npz()[:-10], "no zip archive"),
    "encrypted": (zipped(0, 1), "not an NPZ of numbers"),
    "compressed by a method that it is not": (zipped(2, 12), "not an NPZ of numbers"),
    "damaged": (damaged(npz(), 300), "not an NPZ of numbers"),
    "asks for terabytes": (
        npy(shaped(f"({10**12}, 3)")),
        "not an NPZ of numbers",
    ),
    "too short": (npy(shaped("(5, 3)"), b"abc"), "not an NPZ of numbers"),
    "code": (npy("__import__('os')"), "not an NPZ of numbers"),
    "an endless header": (npy("(" * 5000), "not an NPZ of numbers"),
    "objects": (npz(w1=np.array([object()])), "not an NPZ of numbers"),
    "complex": (npz(w1=MLP.w1 + 1j), "w1: got complex128, expected real numbers"),
    "dates": (npz(b1=np.full(5, np.datetime64(1, "D"))), "b1: got datetime64[D], expected real"),
    "an array is missing": (npz(w2=None), "no array 'w2', got w1, b1, b2"),
    "transposed": (npz(w1=MLP.w1.T), "w1: got shape (3, 5), expected (5, 3) of .*; it is transp"),
    "a number": (npz(b1=5.0), "b1: got shape (), expected (5,) of a 3:5:2 network"),
    "NaN": (npz(b2=MLP.b2 * np.nan), "b2: got NaN or infinity, expected finite numbers"),
    "does not fit": (npz(w1=MLP.w1 * 1e300), "layer 1 weights: largest magnitude"),
}
MAT = {
    "empty": (b"", "not a MATLAB file up to version 7"),
    "cut off": (netlab()[:300], "not a MATLAB file up to version 7"),
    "version 7.3": (
        b"MATLAB 7.3 MAT-file" + b" " * 105 + b"\x00\x02IM" + b"\x89HDF\r\n\x1a\n" + bytes(400),
        "not a MATLAB file up to version 7",
    ),
    "damaged": (damaged(netlab(), 130), "not a MATLAB file up to version 7"),
    "damaged, compressed": (
        damaged(mat({"net": COLUMNS}, do_compression=True), 150, 30),
        "not a MATLAB file up to version 7",
    ),
    "no network": (mat({"a": 1}), "got 0 networks among the variables a, expected one with"),
    "two networks": (mat({"a": COLUMNS, "b": COLUMNS}), "got 2 networks among the variables a, b"),
    "a field is missing": (netlab(w2=None), "got 0 networks among the variables net"),
    "transposed": (netlab(w1=MLP.w1), "w1: got shape (5, 3), expected (3, 5) of .*; it is transp"),
    "complex": (netlab(w1=MLP.w1.T + 1j), "w1: got complex128, expected real numbers"),
    "sparse": (netlab(w1=csc_matrix(MLP.w1.T)), "w1: got object, expected real numbers"),
    "NaN": (netlab(b2=[[np.nan, 1]]), "b2: got NaN or infinity, expected finite numbers"),
}
ONNX = {
    "empty": (b"", "got 0 inputs and 0 outputs, expected a graph with one of each"),
    "an image": (b"\xff\xd8\xff\xe0" + bytes(100), "not an ONNX file"),
    "cut off": (onnx()[:100], "not an ONNX file"),
    "values in a file that is missing": (
        onnx(w1=elsewhere("no.bin")),
        ".*no.bin",
    ),
    "values in a file outside": (onnx(w1=elsewhere("../a.bin")), "not an ONNX file: .*outside"),
    "values in a file of the system": (onnx(w1=elsewhere("/etc/passwd")), "not an ONNX file: "),
    "values of a type that is not known": (onnx(w1=tensor(data_type=77)), "tensor 'w1' holds"),
    "more values than any memory": (onnx(w1=tensor(dims=[1 << 40, 5])), "tensor 'w1' holds number"),
    "a size below 0": (onnx(w1=tensor(dims=[3, -1])), "tensor 'w1': got the shape [3, -1], exp"),
    "text": (
        onnx(w1=helper.make_tensor("w1", TensorProto.STRING, [3, 5], [b"a"] * 15)),
        "w1: got object, expected real numbers",
    ),
    "complex": (onnx(w1=MLP.w1.T + 1j), "w1: got complex128, expected real numbers"),
    "NaN": (onnx(b2=MLP.b2 * np.nan), "b2: got NaN or infinity, expected finite numbers"),
}
TABLE = [
    pytest.param(form, content, message, id=f"{form}-{name}".replace(" ", "_"))
    for form, rows in (("npz", NPZ), ("mat", MAT), ("onnx", ONNX))
    for name, (content, message) in rows.items()
]


@pytest.mark.parametrize(("form", "content", "message"), TABLE)
def test_a_network_is_refused(desk: Desk, form: str, content: bytes, message: str) -> None:
    desk.edit("mine.npz", f"mine.{form}")
    (desk.folder / f"mine.{form}").write_bytes(content)
    desk.refuses("bench", "mine.toml", says=f"mine.{form}: .*{message}")


@pytest.mark.parametrize("form", ["npz", "mat", "onnx"])
def test_a_network_without_hidden_nodes_is_refused(desk: Desk, form: str) -> None:
    """Also if the scene takes as many hidden nodes as the file has."""
    none = {"npz": npz(**NONE), "mat": mat({k: v.T for k, v in NONE.items()})}
    none["onnx"] = onnx(w1=NONE["w1"].T, b1=NONE["b1"], w2=NONE["w2"].T)
    desk.edit("mine.npz", f"mine.{form}")
    desk.edit("hidden = 5", "hidden = 0")
    (desk.folder / f"mine.{form}").write_bytes(none[form])
    desk.refuses("bench", "mine.toml", says=f"mine.{form}: b1: got 0 hidden nodes, expected 1 or")


def test_what_the_rows_change_is_read_without_a_change(desk: Desk) -> None:
    named = "mine.npz"
    for form, content in (("npz", npz()), ("mat", netlab()), ("onnx", onnx())):
        desk.edit(named, f"mine.{form}")
        named = f"mine.{form}"
        (desk.folder / named).write_bytes(content)
        assert desk.call("bench", "mine.toml", "--frames", "9") == (0, "")
