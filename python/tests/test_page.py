"""The code of docs/python.md, docs/learning.md and docs/shield.md runs as it stands there."""

import re

from conftest import TOP



def run(page):
    """The names that a page's code leaves behind, from top to bottom."""
    blocks = re.findall(r"^```python\n(.*?)^```$", (TOP / "docs" / page).read_text(), re.MULTILINE | re.DOTALL)
    names = {"blocks": len(blocks)}
    for block in blocks:
        exec(compile(block, f"docs/{page}", "exec"), names)
    return names


def test_the_code_about_learning_hovers_behind_the_shield(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = run("learning.md")
    assert names["info"]["by_policy"].all() and not names["terminated"].any()
    assert abs(names["observations"][:, :3]).max() < 0.2
    assert "The policy flies" in (tmp_path / "spring.html").read_text()


def test_the_pages_code_runs_from_top_to_bottom(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = run("python.md")
    assert names["blocks"] >= 5
    figure = (tmp_path / "recovery.png").read_bytes()
    assert figure.startswith(b"\x89PNG") and len(figure) > 10_000
    assert names["late"].reasons and names["rewards"].shape == (64,)
    assert names["frame"].shape == (420, 480, 3) and (tmp_path / "climb.gif").read_bytes().startswith(b"GIF89a")
    assert names["references"].shape == (500, 19) and len(names["flight"]) == 600


def test_the_shields_code_runs():
    names = run("shield.md")
    assert names["shields"].hand_overs.max() >= 1 and names["shields"].reasons
