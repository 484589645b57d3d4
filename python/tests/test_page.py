"""The code of docs/python.md and of docs/shield.md runs as it stands there, and draws its figure."""

import re

from conftest import TOP

PAGE = (TOP / "docs" / "python.md").read_text()


def test_the_pages_code_runs_from_top_to_bottom(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    assert len(blocks) >= 5
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    figure = (tmp_path / "recovery.png").read_bytes()
    assert figure.startswith(b"\x89PNG") and len(figure) > 10_000
    assert names["late"].reasons and names["rewards"].shape == (64,)
    assert names["references"].shape == (500, 19) and len(names["flight"]) == 600


def test_the_shields_code_runs():
    page = (TOP / "docs" / "shield.md").read_text()
    (block,) = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    names = {}
    exec(compile(block, "docs/shield.md", "exec"), names)
    assert names["shields"].hand_overs.max() >= 1 and names["shields"].reasons
