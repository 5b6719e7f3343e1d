# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Help with an example that works, the nearest word for a wrong one, and completion."""

import shlex
import shutil
import subprocess
import sys

import pytest

from reflest_core.cli.main import command_parser, main
from reflest_core.cli.parser import EXAMPLES, _parsers


def test_every_command_has_an_example():
    parsers = _parsers(command_parser(()))
    commands = {one.prog.removeprefix("reflest").strip() for one in parsers}
    assert commands == set(EXAMPLES)


@pytest.mark.parametrize("command", EXAMPLES)
def test_the_example_is_shown_and_can_be_parsed(command, capsys):
    line = EXAMPLES[command]
    words = shlex.split(line.split(" > ")[0])[1:]
    command_parser(words).parse_args(words)
    with pytest.raises(SystemExit):
        main([*command.split(), "--help"])
    assert f"example: {line}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["replya", "x"], "replay"),
        (["replay", "x", "--josn", "out"], "--json"),
        (["view", "x", "--roi-shpere", "0"], "--roi-sphere"),
        (["export", "x", "--out", "y.glb", "--format", "gbl"], "glb"),
        (["synbrdf", "sequense"], "sequence"),
    ],
)
def test_a_wrong_word_names_the_nearest(words, meant, capsys):
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    assert f"did you mean {meant}?" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["replay", "view", "export"])
def test_a_wrong_path_names_the_nearest_before_anything_slow(command, tmp_path):
    (tmp_path / "kitchen.mcap").touch()
    more = ["--format", "glb", "--out", "x.glb"] if command == "export" else []
    code = (
        "import sys; from reflest_core.cli.main import main\n"
        f"code = main([{command!r}, {str(tmp_path / 'kitchn.mcap')!r}, *{more}])\n"
        "print('SLOW', {'numba', 'cv2', 'scipy', 'open3d', 'viser'} & set(sys.modules))\n"
        "sys.exit(code)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2
    assert f"did you mean {tmp_path / 'kitchen.mcap'}?" in done.stderr
    assert "SLOW set()" in done.stdout


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_completes_commands_and_options(capsys, tmp_path):
    assert main(["completion", "bash"]) == 0
    script = tmp_path / "reflest.bash"
    script.write_text(capsys.readouterr().out)
    ask = (
        f"source {script}; COMP_WORDS=(reflest replay --re); COMP_CWORD=2; COMP_LINE='reflest "
        "replay --re'; COMP_POINT=19; _shtab_reflest; echo ${COMPREPLY[@]}"
    )
    done = subprocess.run(["bash", "-c", ask], capture_output=True, text=True)
    assert done.stdout.split() == ["--report"]


def test_a_missing_extra_names_its_pip_command(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["completion", "bash"]) == 2
    assert "pip install 'reflest-ros[completion]'" in capsys.readouterr().err
