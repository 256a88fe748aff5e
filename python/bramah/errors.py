"""What can go wrong."""

from __future__ import annotations

from typing import Any


class Error(Exception):
    """A circuit, a value or a study is wrong, or a run did not reach its end.

    Prints as on the command line: with the text concerned, causes and help.

    Attributes:
        code: such as "E103"; `bramah explain E103` shows its page.
        help: what to do, or "".
        file, line: the place in the text, or None.
        diagnostics: all of what was said, as dicts with code, severity, message, help, file, line.
    """

    def __init__(self, text: str, diagnostics: list[dict[str, Any]] | None = None) -> None:
        super().__init__(text)
        self.diagnostics = diagnostics or []
        errors = [d for d in self.diagnostics if d["severity"] == "error"]
        first = (errors or self.diagnostics or [{}])[0]
        self.code: str = first.get("code", "")
        self.help: str = first.get("help", "")
        self.file: str | None = first.get("file")
        self.line: int | None = first.get("line")

    def meant(self, hint: str) -> Error:
        """The same error with one more line of help."""
        diagnostics = [dict(d) for d in self.diagnostics]
        for d in diagnostics[:1]:
            d["help"] = "\n".join(filter(None, [d["help"], hint]))
        return Error(f"{self.args[0]}\n = help: {hint}", diagnostics)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Error, (self.args[0], self.diagnostics))
