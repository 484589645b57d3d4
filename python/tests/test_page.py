"""The code of docs/python.md runs as it stands there, and draws its figure."""

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
    assert names["frame"].shape == (420, 480, 3) and (tmp_path / "climb.gif").read_bytes().startswith(b"GIF89a")
    assert names["references"].shape == (500, 19) and len(names["flight"]) == 600
