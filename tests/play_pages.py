"""The page of `fretc play` in a browser: how it is found, and what its lanes say."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

HOSTILE = "</script><script>document.title='broken'</script>\u202e"
Open = Callable[..., "Page"]


def expected_to(subject: Any) -> Any:
    """What waits for it to come true."""
    from playwright.sync_api import expect

    return expect(subject)


def lane(page: Page, label: str, note: str = "") -> Locator:
    """The cells of a lane."""
    name = f"{label} {note}".strip()
    return (
        page.locator("#grid tbody tr")
        .filter(has=page.get_by_role("rowheader", name=name, exact=True))
        .locator("td")
    )


def told(page: Page, label: str, note: str = "") -> list[str]:
    """What a lane says to who hears it, tick by tick."""
    labels = [cell.get_attribute("aria-label") or "" for cell in lane(page, label, note).all()]
    assert all(f"at tick {t}: " in text for t, text in enumerate(labels))
    return [text.split(": ", 1)[1] for text in labels]


def everything(page: Page) -> dict[str, list[str]]:
    """All lanes at once: their heads, and what each cell says."""
    found: dict[str, list[str]] = page.evaluate(
        "Object.fromEntries([...document.querySelectorAll('#grid tbody tr')].map(row =>"
        " [row.cells[0].textContent.trim(), [...row.cells].slice(1)"
        ".map(cell => cell.ariaLabel.split(': ').slice(1).join(': '))]))"
    )
    return found


def address(rows: Sequence[Mapping[str, bool | None]]) -> str:
    names = rows[0]
    values = {
        name: "_".join("u" if row[name] is None else str(int(bool(row[name]))) for row in rows)
        for name in names
    }
    return f"#ticks={len(rows)}" + "".join(f"&v.{name}={text}" for name, text in values.items())
