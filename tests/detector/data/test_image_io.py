"""Image files that decoders would misread without a warning."""

import io
import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import ExifTags, Image

from foreride.detector.data.image_io import exif_orientation, read_image
from foreride.detector.data.yolo_folder import read_samples
from foreride.files.errors import InputError
from tests.detector.roads import write

PICTURE = np.random.default_rng(0).integers(0, 255, (40, 60, 3)).astype(np.uint8)


def jpeg(orientation: int | None = None, order: str = "<") -> bytes:
    """A JPEG file, with an EXIF block that holds one entry (EXIF 2.32, 4.5.2 and 4.6.2) if asked for."""
    data = cv2.imencode(".jpg", PICTURE)[1].tobytes()
    if orientation is None:
        return data
    mark = b"II*\0" if order == "<" else b"MM\0*"
    entry = struct.pack(f"{order}HHIHH", 0x0112, 3, 1, orientation, 0)
    block = b"Exif\0\0" + mark + struct.pack(f"{order}I", 8) + struct.pack(f"{order}H", 1) + entry + b"\0" * 4
    return data[:2] + b"\xff\xe1" + struct.pack(">H", len(block) + 2) + block + data[2:]


def written(mode: str) -> bytes:
    """A PNG file in one of Pillow's modes."""
    stream = io.BytesIO()
    Image.fromarray(PICTURE).convert(mode).save(stream, "PNG")
    return stream.getvalue()


def damaged(data: bytes) -> bytes:
    """File with some bytes in the middle lost."""
    return data[: len(data) // 2] + bytes(40) + data[len(data) // 2 + 40 :]


def zero_wide() -> bytes:
    """A PNG file whose header says that the image has no columns (ISO 15948, 5.3 and 11.2.2)."""
    data = written("RGB")
    head = b"IHDR" + struct.pack(">I", 0) + data[20:29]
    return data[:12] + head + struct.pack(">I", zlib.crc32(head)) + data[33:]


@pytest.mark.parametrize("suffix", [".png", ".bmp", ".jpg"])
def test_a_good_file_is_read_as_rgb(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    cv2.imwrite(str(path), PICTURE[..., ::-1])
    seen = read_image(path)
    assert seen.shape == PICTURE.shape
    if suffix != ".jpg":
        np.testing.assert_array_equal(seen, PICTURE)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("orientation", [1, 3, 6, 8])
def test_orientation_is_read_in_either_byte_order(tmp_path: Path, orientation: int, order: str) -> None:
    path = tmp_path / "a.jpg"
    path.write_bytes(jpeg(orientation, order))
    assert exif_orientation(path.read_bytes()) == orientation
    if orientation == 1:
        assert read_image(path).shape == PICTURE.shape
    else:
        with pytest.raises(InputError, match=rf"a\.jpg: EXIF orientation {orientation}"):
            read_image(path)


@pytest.mark.parametrize(("suffix", "turned"), [("png", 6), ("webp", 8), ("png", 1), ("jpeg", 0)])
def test_orientation_is_read_from_other_kinds_of_files_too(tmp_path: Path, suffix: str, turned: int) -> None:
    exif = Image.Exif()
    exif[ExifTags.Base.Orientation] = turned
    path = tmp_path / f"a.{suffix}"
    Image.fromarray(PICTURE).save(path, exif=exif)
    if turned <= 1:  # 0 is none of the orientations
        assert read_image(path).shape == PICTURE.shape
    else:
        with pytest.raises(InputError, match=f"EXIF orientation {turned}"):
            read_image(path)


@pytest.mark.parametrize("length", range(0, 26, 3))
def test_a_broken_exif_block_says_nothing(length: int) -> None:
    data = jpeg(6)
    start = data.index(b"Exif\0\0")
    assert exif_orientation(data[: start + length]) == 1


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.jpg", b"", "empty file"),
        ("a.jpg", b"hello", "cannot be decoded"),
        ("a.jpg", jpeg()[:-400], "truncated"),
        ("a.png", cv2.imencode(".png", PICTURE)[1].tobytes()[:-300], "truncated"),
        ("a.png", cv2.imencode(".png", PICTURE.astype(np.uint16) * 256)[1].tobytes(), "16 bits"),
        ("a.png", cv2.imencode(".png", PICTURE[..., 0])[1].tobytes(), "grey"),
        ("a.png", written("LA"), "grey"),
        ("a.jpg", cv2.imencode(".jpg", PICTURE[..., 0])[1].tobytes(), "grey"),
        ("a.png", damaged(cv2.imencode(".png", PICTURE)[1].tobytes()), "cannot be decoded"),
        ("a.png", zero_wide(), "cannot be decoded"),
        ("a.bmp", cv2.imencode(".bmp", PICTURE)[1].tobytes()[:-300], "cannot be decoded"),
        ("a.webp", cv2.imencode(".webp", PICTURE)[1].tobytes()[:-30], "cannot be decoded"),
    ],
)
def test_bad_files_are_named_with_their_fault(tmp_path: Path, name: str, data: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=message) as error:
        read_image(tmp_path / name)
    assert str(tmp_path / name) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_data_set_lists_all_its_bad_files_or_leaves_them_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write(tmp_path / "data", 4)
    (folder / "images" / "000.png").write_bytes(b"")
    cv2.imwrite(str(folder / "images" / "001.png"), PICTURE[..., 0])
    (folder / "labels" / "002.txt").write_text("0 2 2 2 2\n")
    with pytest.raises(InputError, match="3 files cannot be used") as error:
        list(read_samples(folder))
    assert all(part in str(error.value) for part in ("000.png: empty", "001.png: a grey", "002.txt:1"))
    assert [sample.name for sample in read_samples(folder, skip_bad=True)] == ["003.png"]
    assert capsys.readouterr().err.count("left out") == 3
    (folder / "images" / "003.png").write_bytes(b"")
    with pytest.raises(InputError, match="4 files cannot be used"):
        list(read_samples(folder, skip_bad=True))


def test_a_folder_without_labels_is_no_data_set(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    cv2.imwrite(str(tmp_path / "images" / "a.png"), PICTURE)
    with pytest.raises(InputError, match="no folder labels/"):
        next(read_samples(tmp_path))
