"""``--help``: a text for every option of every command, its default, and an example that its parser reads."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterator

import pytest

from contact.catalogue import ALGORITHMS
from studies import cli
from studies.commands.options import named, pairs
from studies.commands.sweep import ranges
from studies.scenes import SCENES
from studies.scenes.complete import complete


def below(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """A parser and those of its own commands."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for each in dict.fromkeys(action.choices.values()):
                yield from below(each)


def parsers() -> dict[str, argparse.ArgumentParser]:
    """Of all commands, by the words after ``footprint``."""
    by_name = {}
    for name in cli.COMMANDS:
        (commands,) = (each for each in cli._parser([name])._actions if isinstance(each, argparse._SubParsersAction))
        by_name |= {each.prog.removeprefix("footprint "): each for each in below(commands.choices[name])}
    return by_name


PARSERS, EXAMPLES = parsers(), cli.examples()


def arguments(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    """What is to be told of: all but the help itself and commands, which have a line of their own."""
    return [each for each in parser._actions if not isinstance(each, argparse._HelpAction | argparse._SubParsersAction)]


def test_all_commands_are_walked() -> None:
    assert {"solve", "run", "bench solvers", "problems judge"} <= PARSERS.keys()
    assert {name.split()[0] for name in PARSERS} == {*cli.COMMANDS}
    assert PARSERS.keys() == EXAMPLES.keys()


@pytest.mark.parametrize("name", PARSERS)
def test_every_argument_has_a_text_and_its_default(name: str) -> None:
    parser = PARSERS[name]
    stated = " ".join(parser.format_help().split())
    for action in arguments(parser):
        words = action.option_strings or [action.dest]
        assert action.help, words
        assert not action.help.startswith("default"), words
        if action.option_strings and action.default not in (None, False, "", []):
            shown = parser._get_formatter()._expand_help(action)
            assert "default" in shown, words
            assert " ".join(shown.split()).replace("-", "") in stated.replace("-", ""), words


@pytest.mark.parametrize("name", PARSERS)
def test_every_option_is_in_an_example_and_every_example_is_read(name: str) -> None:
    examples = [shlex.split(line) for line in EXAMPLES[name]]
    assert examples
    used = {word for words in examples for word in words}
    for action in arguments(PARSERS[name]):
        if action.option_strings:
            assert used & {*action.option_strings}, action.option_strings
    for words in examples:
        PARSERS[name].parse_args(words)


@pytest.mark.parametrize("name", ["solve", "choose", "sweep", "export", "judge-field"])
def test_scenes_and_settings_of_examples_are_there(name: str) -> None:
    """Of what the catalogues have; parts and files of one's own are not."""
    for words in map(shlex.split, EXAMPLES[name]):
        asked = PARSERS[name].parse_args(words)
        if asked.scene in SCENES and getattr(asked, "contact", "semismooth") in ALGORITHMS:
            how = named(asked, *(key for key in ("measure", "contact", "newton", "model", "steps") if key in asked))
            how = {key: value for key, value in how.items() if value is not None}
            given = {**pairs(asked.settings), **{key: text.partition(":")[0] for key, text in over(asked).items()}}
            assert complete(asked.scene, given, asked.mesh, **how)
            if getattr(asked, "of", None):
                assert asked.of in {each.quantity for each in SCENES[asked.scene].references} | {"force_N"}


def over(asked: argparse.Namespace) -> dict[str, str]:
    """The ranges of a sweep."""
    return ranges(getattr(asked, "over", []))


def test_help_ends_with_examples_as_they_are_written(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cli.main(["solve", "--help"])
    lines = capsys.readouterr().out.splitlines()
    at = lines.index("examples:")
    assert lines[at + 1 :] == [f"  footprint solve {words}" for words in EXAMPLES["solve"]]
