"""What all verbs share: how they are found, listed, and which options every one takes."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from exo_sim.errors import nearest
from exo_sim.version import VERSION

#: The verbs in the order of the list; one is there as soon as its file is.
VERBS = ("run", "scenarios", "inspect", "view", "compare", "diagnose", "effects", "size", "trial", "doctor")

_FOLDER = Path(__file__).parent
_NAMES = {"help_option_names": ["-h", "--help"], "max_content_width": 110}


class Verb(click.Command):
    """A verb whose help ends with examples."""

    examples: Sequence[str] = ()

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Example" if len(self.examples) == 1 else "Examples"):
            for example in self.examples:
                formatter.write(f"{'':{formatter.current_indent}}{example}\n")


class VerbGroup(click.Group):
    """A verb that has verbs of its own, like `exo-sim trial make`."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        if verbs := self.one_liners(ctx):
            with formatter.section("Verbs"):
                formatter.write_dl(verbs)

    def one_liners(self, ctx: click.Context) -> list[tuple[str, str]]:
        """Return (verb, what it does in one line) for the list."""
        held = [(name, self.get_command(ctx, name)) for name in self.list_commands(ctx)]
        return [(name, (verb.help or "").split("\n", 1)[0].removesuffix(".")) for name, verb in held if verb is not None]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if not args[0].startswith("-") and self.get_command(ctx, args[0]) is None:
            ctx.fail(f'no verb "{args[0]}"{nearest(args[0], self.list_commands(ctx))}')
        return super().resolve_command(ctx, args)


class Program(VerbGroup):
    """The verbs of `exo_sim.cli`, each imported when it is used and listed without being imported."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [name for name in VERBS if (_FOLDER / f"{name}.py").is_file()]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            return None
        module = importlib.import_module(f"exo_sim.cli.{cmd_name}")
        command = module.command
        assert isinstance(command, click.Command)
        return command

    def one_liners(self, ctx: click.Context) -> list[tuple[str, str]]:
        return [(name, _one_line(name)) for name in self.list_commands(ctx)]


def _one_line(name: str) -> str:
    """Return the first line of a verb's module docstring without importing it."""
    tree = ast.parse((_FOLDER / f"{name}.py").read_text(encoding="utf-8"))
    return (ast.get_docstring(tree) or "").split("\n", 1)[0].removesuffix(".")


def verb(
    *examples: str, out: str, seed: bool = False, name: str | None = None
) -> Callable[[Callable[..., Any]], click.Command]:
    """Make a verb of a function: its docstring is the help, and it takes the options that every verb takes.

    The function is called with `as_json: bool`, `out: Path | None`, `quiet: bool` and, where chance plays a part,
    `seed: int`, beside the options of its own. It returns None or an exit status.

    Args:
        examples: Complete commands, printed at the end of `--help`.
        out: What `--out` means here, for `--help`.
        seed: Whether chance plays a part.
        name: The verb's name where it is not the name of its file (the verbs of a group).
    """

    def decorate(function: Callable[..., Any]) -> click.Command:
        command = click.command(
            name=name or function.__module__.rpartition(".")[2], cls=Verb, context_settings=dict(_NAMES)
        )(function)
        assert isinstance(command, Verb)
        command.examples = examples
        command.params += _common(out, seed)
        return command

    return decorate


def group(help: str, name: str) -> VerbGroup:
    """Make a verb that holds verbs; add them with `group.add_command`."""
    return VerbGroup(
        name=name,
        help=help,
        context_settings=dict(_NAMES),
        no_args_is_help=True,
        subcommand_metavar="VERB ...",
        params=[_debug()],
    )


def _common(out: str, seed: bool) -> list[click.Parameter]:
    options: list[click.Parameter] = [
        click.Option(["--out"], type=click.Path(path_type=Path), help=out),
        click.Option(["--json", "as_json"], is_flag=True, help="Print one JSON object on stdout, nothing else there."),
        click.Option(["--quiet", "-q"], is_flag=True, help="No progress, no remarks; errors still show."),
    ]
    if seed:
        seeds = click.IntRange(0, 2**32 - 1)
        options.append(click.Option(["--seed"], type=seeds, default=0, show_default=True, help="Seed of the random numbers."))
    return [*options, _debug()]


def _debug() -> click.Option:
    # main reads it from the arguments, so that it shows faults of the reading of arguments too
    return click.Option(["--debug"], is_flag=True, expose_value=False, help="Show the traceback of an error.")


program = Program(
    name="exo-sim",
    help="Simulate a person walking in a pneumatic exoskeleton, and compare it with recordings of real machines.",
    epilog="exo-sim VERB --help shows its options and an example. Exit status: 0; 2 for unusable input; 3 (something is missing) and 4 "
    "(cannot tell) for verdicts of diagnose; 5 where a simulation left all bounds or the machine fell; 130 after an interrupt.",
    context_settings=dict(_NAMES),
    params=[_debug()],
    no_args_is_help=True,
    subcommand_metavar="VERB ...",
    options_metavar="",
)
click.version_option(VERSION, prog_name="exo-sim", message="%(prog)s %(version)s")(program)
