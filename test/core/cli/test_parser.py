# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Help with an example that works, the nearest word for a wrong one, and completion."""

import builtins
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from reflest_core.cli.main import command_parser, main
from reflest_core.cli.parser import EXAMPLES, _parsers
from reflest_core.cli.replay import EPILOG
from reflest_core.estimation.settings import ReflestSettings


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


def test_the_help_says_every_options_default():
    for parser in _parsers(command_parser(())):
        text = " ".join(parser.format_help().split())
        for action in parser._actions:
            if action.option_strings and action.nargs != 0 and not action.required:
                assert "default" in action.help, (parser.prog, action.option_strings)
                assert " ".join((action.help % vars(action)).split()) in text.replace("- ", "-")


def test_defaults_are_those_of_the_settings(capsys):
    with pytest.raises(SystemExit):
        main(["replay", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    settings = ReflestSettings()
    assert f"edge of a voxel; default: {settings.fusion.voxel_size}" in text
    assert f"background; default: {settings.fusion.max_depth:g} " in text
    assert "--rgb-topic TOPIC default: found by its type" in text


def test_the_help_of_replay_lists_every_format_of_the_documentation():
    page = (Path(__file__).parents[3] / "docs" / "captures.md").read_text()
    table = page.partition("| format |")[2].partition("\n\n")[0].splitlines()[2:]
    formats = [line.split("|")[1].split("(")[0].strip() for line in table]
    assert len(formats) == 13
    assert [one for one in formats if one not in " ".join(EPILOG.split())] == []


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


def test_a_name_that_only_shares_a_suffix_is_not_suggested(tmp_path, capsys):
    (tmp_path / "red.hdr").touch()
    for wrong, hint in (("nope.hdr", ""), ("rad.hdr", "; did you mean "), ("red.exr", "; did")):
        assert main(["replay", str(tmp_path / wrong)]) == 2
        error = capsys.readouterr().err
        assert f"{wrong} does not exist{hint}" in error
        assert ("did you mean" in error) == bool(hint)


@pytest.mark.parametrize("words", [["{}"], ["x.mcap", "--json", "{}/x.json"]])
def test_a_path_that_is_too_long_ends_in_one_sentence(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.mcap").touch()
    assert main(["replay", *(word.format("a" * 300) for word in words)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("reflest: error: ")
    assert error.count("\n") == 1


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


CAPTURE = str(Path(__file__).parents[3] / "captures" / "glossy-red")
WITHOUT = (
    (["view", CAPTURE], "viser", "viewer"),
    (["replay", CAPTURE, "--report", "OUT.html"], "open3d", "asset"),
    (["replay", CAPTURE, "--report", "OUT.html"], "fast_simplification", "asset"),
    (["export", CAPTURE, "--format", "glb", "--out", "OUT.glb"], "xatlas", "asset"),
    (["export", CAPTURE, "--format", "glb", "--out", "OUT.glb"], "trimesh", "asset"),
    (["export", CAPTURE, "--format", "usd", "--out", "OUT.usda"], "pxr", "asset"),
    (["train", CAPTURE, "--model", "lightnet", "--out", "OUT"], "torch", "training"),
    (["evaluate", CAPTURE, "--out", "OUT", "--parts", "perception"], "skimage", "training"),
    (["synbrdf", "sequence", "--environments", CAPTURE, "--out", "OUT"], "mitsuba", "synbrdf"),
    (["completion", "bash"], "shtab", "completion"),
)
"""Commands, a library that they cannot do without, and the extra that brings it."""


@pytest.mark.parametrize(("words", "library", "extra"), WITHOUT)
def test_a_missing_extra_names_its_pip_command(words, library, extra, tmp_path):
    code = (
        f"import sys; sys.modules[{library!r}] = None\n"
        f"from reflest_core.cli.main import main; sys.exit(main({words!r}))"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, env=environment
    )
    assert done.returncode == 2
    (line,) = done.stderr.strip().splitlines()
    assert f"pip install 'reflest-ros[{extra}]'" in line
    assert library in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["replay", CAPTURE, "--json", "nosuch/a.json"], "cannot write nosuch/a.json"),
        (["evaluate", "nosuch"], "nosuch does not exist"),
        (["replay", CAPTURE, "--config", "nosuch.yaml"], "nosuch.yaml does not exist"),
        (["replay", CAPTURE, "--weights", "nosuch"], "nosuch does not exist"),
        (["replay", CAPTURE, "--known-light", "nosuch.hdr"], "nosuch.hdr does not exist"),
        (["view", CAPTURE, "--environment", "nosuch.hdr"], "nosuch.hdr does not exist"),
        (["export", CAPTURE, "--format", "glb", "--out", "nosuch/a.glb"], "cannot write nosuch"),
    ],
)
def test_a_wrong_path_in_an_option_ends_before_anything_slow(
    words, sentence, capsys, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    opened = []
    monkeypatch.setattr("builtins.__import__", _noting(opened, builtins.__import__))
    assert main(words) == 2
    assert sentence in capsys.readouterr().err
    assert not {"reflest_core.capture.open_capture", "open3d", "viser"} & set(opened)


def _noting(names, real):
    def imported(name, *arguments, **options):
        names.append(name)
        return real(name, *arguments, **options)

    return imported


def test_a_link_to_nothing_is_named_as_one(tmp_path, capsys):
    (tmp_path / "kitchen").symlink_to("nowhere")
    assert main(["replay", str(tmp_path / "kitchen")]) == 2
    assert f"{tmp_path / 'kitchen'} is a link to nothing: nowhere" in capsys.readouterr().err
