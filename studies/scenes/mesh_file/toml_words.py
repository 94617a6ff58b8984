"""Words of a TOML file, each with the key it stands under, so that what is wrong is refused by name."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from studies.ask.request import UsageError
from studies.scenes.mesh_file.keywords import listed, shown

LARGEST_TOML = 1_000_000  # bytes
LARGEST = 1e15  # of a number


@dataclass(frozen=True)
class Said:
    """A value and where it stands."""

    file: str
    key: str
    value: object

    @classmethod
    def of(cls, path: Path) -> Said:
        """All of a file; raises UsageError for what is not TOML, and OSError."""
        if path.stat().st_size > LARGEST_TOML:
            raise UsageError(f"{path}: larger than {LARGEST_TOML // 10**6} MB")
        try:
            return cls(path.name, "", tomllib.loads(path.read_text(encoding="utf-8")))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
            raise UsageError(f"{path.name}: is not TOML: {' '.join(str(error).split())}") from None

    def refuse(self, why: str) -> NoReturn:
        """Raise UsageError with file and key."""
        raise UsageError(f"{self.file}{self.key and ': '}{self.key}{' ' * (why[:1] not in ',:')}{why}")

    def table(self, *known: str) -> dict[str, Said]:
        """Its values by key, none but the known ones where there are any."""
        if not isinstance(self.value, dict):
            self.refuse("must be a table")
        for key in self.value:
            if known and key not in known:
                self.refuse(f"has a key {shown(key)} that is not understood; understood are {', '.join(known)}")
        return {
            key: Said(self.file, f"{self.key}{self.key and '.'}{shown(key)}", each) for key, each in self.value.items()
        }

    def needs(self, *keys: str) -> list[Said]:
        """The values of a table of these keys, none of which may be missing."""
        table = self.table(*keys)
        missing = [key for key in keys if key not in table]
        if missing:
            self.refuse(f"needs {listed(missing)}")
        return [table[key] for key in keys]

    def items(self, count: int | None = None) -> list[Said]:
        """The values of a list, of that many."""
        if not isinstance(self.value, list) or count not in (None, len(self.value)):
            self.refuse("must be a list" if count is None else f"must be a list of {count}")
        return [Said(self.file, f"{self.key}[{i}]", each) for i, each in enumerate(self.value)]

    def real(self) -> float:
        """A finite number."""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            self.refuse("must be a number")
        if not (math.isfinite(self.value) and abs(self.value) <= LARGEST):
            self.refuse(f"must lie in [-{LARGEST:g}, {LARGEST:g}]")
        return float(self.value)

    def text(self) -> str:
        """A word."""
        return self.value if isinstance(self.value, str) else self.refuse("must be a word in quotes")

    def flag(self) -> bool:
        """True or false."""
        return self.value if isinstance(self.value, bool) else self.refuse("must be true or false")
