"""Options of the command as keyword arguments, from the table that its --help is made from."""

import difflib
import inspect
import keyword
import numbers
import os

try:
    from . import _rfsmooth
except ImportError:  # stub.py, which runs before there is a package
    import _rfsmooth  # type: ignore[no-redef]


def python_name(name):
    """--push-alpha is push_alpha; --lambda, a word of the language, lambda_."""
    name = name.replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


_READ = {"flag": lambda text: text == "true", "integer": int, "number": float}


def _default(entry):
    text = entry["default"]
    return None if text is None else _READ.get(entry["kind"], str)(text)


class Table:
    """The options of one sub-command."""

    def __init__(self, command):
        self.command = command
        self.entries = {python_name(e["name"]): e for e in _rfsmooth.option_table(command)}

    def parameters(self):
        """As inspect has them: keyword-only, with defaults."""
        return [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=_default(entry))
            for name, entry in self.entries.items()
        ]

    def documentation(self):
        """A line for each option."""
        lines = []
        for name, entry in self.entries.items():
            notes = [entry["unit"], entry["range"], ", ".join(entry["choices"])]
            notes = "; ".join(note for note in notes if note)
            lines.append(f"    {name}: {entry['help']}" + (f" ({notes})" if notes else ""))
        return "\n".join(lines)

    def check_names(self, given):
        """TypeError for a name that is no option, as Python has it, with a suggestion."""
        for name in given:
            if name not in self.entries:
                near = difflib.get_close_matches(name, self.entries, 1)
                hint = f"; did you mean '{near[0]}'?" if near else ""
                function = python_name(self.command)
                raise TypeError(f"{function}() got an unexpected keyword argument '{name}'{hint}")

    def texts(self, given):
        """Names and values as the command has them; a file that is None is left out."""
        self.check_names(given)
        return [
            (self.entries[name]["name"], self._text(name, value))
            for name, value in given.items()
            if value is not None or self.entries[name]["kind"] != "file"
        ]

    def from_config(self, config):
        """The options in a report, or in an object of options, with their names here."""
        of_file = next((file for file in config.get("files", ()) if "options" in file), config)
        options = of_file.get("options", config)
        return {
            python_name(name): value
            for name, value in options.items()
            if value is not None and name not in ("format", "encoding", "drop-unsupported")  # chosen anew; of files
        }

    def _text(self, name, value):
        if value is None:
            if self.entries[name]["optional"]:
                return "auto"
            raise TypeError(f"{name} must not be None")
        if isinstance(value, str):
            return value
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        if self.entries[name]["kind"] == "flag" or isinstance(value, bool):
            return "true" if value else "false"  # refused where a number is needed
        if isinstance(value, numbers.Integral):
            return str(int(value))
        if isinstance(value, numbers.Real):
            return repr(float(value))
        return ",".join(repr(float(v)) for v in value)  # a point or a direction


def takes_options(command):
    """Decorates a function that ends in **options: its signature and help name every option."""

    def decorate(function):
        table = Table(command)
        signature = inspect.signature(function)
        own = list(signature.parameters.values())[:-1]
        for parameter in own:
            table.entries.pop(parameter.name, None)
        first = [p for p in own if p.kind != inspect.Parameter.KEYWORD_ONLY]
        last = [p for p in own if p.kind == inspect.Parameter.KEYWORD_ONLY]
        function.__signature__ = signature.replace(parameters=first + table.parameters() + last)
        function.__doc__ += "\n\nOptions, as of the command (None: chosen from the data, or the flow's own):\n"
        function.__doc__ += table.documentation() + "\n"
        function.table = table
        return function

    return decorate
