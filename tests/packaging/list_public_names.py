"""Print a program that asks a type checker for the type of each public name and its members."""

import importlib
import inspect

PACKAGES = ("agent", "inference", "kb", "nlu", "ontology", "sim")


def members(kind: type) -> list[str]:
    """Public attributes and methods of a class; of an error or a text only its own."""
    owners = [owner for owner in kind.__mro__ if owner.__module__.startswith("hilt.")]
    names = {name for owner in owners for name in (*vars(owner), *inspect.get_annotations(owner))}
    return sorted(name for name in names if not name.startswith("_"))


def main() -> None:
    """Print the imports, and for each name what reveals its type."""
    lines = [f"import hilt.{package}" for package in PACKAGES]
    for package in PACKAGES:
        module = importlib.import_module(f"hilt.{package}")
        for name in module.__all__:
            path, value = f"hilt.{package}.{name}", getattr(module, name)
            lines.append(f"reveal_type({path})")
            if inspect.isclass(value):
                lines.append(f"def of_{package}_{name}(value: {path}) -> None:\n    pass")
                lines += [f"    reveal_type(value.{member})" for member in members(value)]
    print("\n".join(lines))


if __name__ == "__main__":
    main()
