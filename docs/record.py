"""Run every example of the pages and of the command line again, and write down what they print now.

    python docs/record.py            all of them, some minutes
    python docs/record.py NAME ...   these alone: commands, as in `simulate`, and pages, as in `tutorial` or `effects/air`

Parts of pages that are made of the source (`extensions/generated.py`) are made anew every time.

The tests hold what is written against what is printed; run this where a change of the program is meant to change it. A new
command needs a file `docs/recorded/NAME.txt` with a line `$ anet-lumped NAME ...`. Commands whose files it needs may stand before
it in the same way.
"""

import shutil
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
FIGURES = (".svg", ".gif", ".png")
sys.path.insert(0, str(HERE / "extensions"))

from generated import filled  # noqa: E402

from examples import examples, run, run_command, transcript  # noqa: E402


def record_command(file):
    """Run the commands of a file in order, in one folder, and write what each prints below it."""
    commands = [command for command, _ in transcript(file.read_text(encoding="utf-8"))]
    with tempfile.TemporaryDirectory() as folder:
        printed = [f"$ {command}\n{run_command(command, folder)}" for command in commands]
    file.write_text("".join(printed), encoding="utf-8")


def record_document(file):
    """Run the examples of a document in order, and write what they print where the document says what they print."""
    text, names, parts, at = file.read_text(encoding="utf-8"), {"__name__": "document"}, [], 0
    with tempfile.TemporaryDirectory() as folder:
        for example in examples(text):
            printed = run(example, names, folder, file.name)
            if printed and not example.is_said:
                raise SystemExit(
                    f"{file.name}: this code prints, and no block of text follows it:\n{example.code}"
                )
            parts += [text[at : example.begin], printed]
            at = example.end
        for figure in (entry for entry in Path(folder).iterdir() if entry.suffix in FIGURES):
            shutil.copy(figure, HERE / "figures")
    file.write_text("".join(parts) + text[at:], encoding="utf-8")


def documents():
    """Return the pages that have examples."""
    return [
        page for page in sorted(HERE.rglob("*.md")) if examples(page.read_text(encoding="utf-8"))
    ]


def main(asked):
    """Record what is asked for, or all."""
    files = {
        file.stem: (record_command, file) for file in sorted((HERE / "recorded").glob("*.txt"))
    }
    files |= {
        file.relative_to(HERE).with_suffix("").as_posix(): (record_document, file)
        for file in documents()
    }
    for page in sorted(HERE.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        page.write_text(filled(text), encoding="utf-8")
    for name in asked or files:
        record, file = files[name]
        record(file)
        print(f"recorded {file.relative_to(HERE)}")


if __name__ == "__main__":
    main(sys.argv[1:])
