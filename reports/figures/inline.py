"""Pictures inside the file: small, named for who cannot see them, and in the colours of the scheme.

Coordinates have two decimals, ids that nothing asks for are gone, and shapes that pictures have in common, letters
above all, are in the file once.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from html import escape

DECIMALS = 2
SHAPE = re.compile(r'<path id="([^"]+)"( [^>]*)/>')  # as defined for many uses
STYLE = re.compile(r' style="([^"]*)"')
FEW = 3  # uses up to which a look has no name
EVERYWHERE = "*{stroke-linejoin: round; stroke-linecap: butt}"  # matplotlib's style; tables.css has it
# what lies on a colour of its own stays as it is drawn; all else takes paper and ink from the scheme
OWN_PAPER = re.compile(r'<image|id="(?:QuadMesh|PolyCollection|FillBetween|TriMesh|Poly3D|Path3D|pane3d)')
SCHEME = {  # colours of a plot, and what they are in the scheme; the greys by how light they are
    "#ffffff": "var(--paper)",
    "#000000": "var(--ink)",
    "#661100": "var(--wine)",
    r"#([ef][0-9a-f])\1\1": "var(--band)",
    r"#(d[0-9a-f])\1\1": "var(--grid)",
    r"#([0-5][0-9a-f])\1\1": "var(--dark)",
}


class Pictures:
    """The pictures of all pages by file name; ``shown``: how often each is shown, though it is in the file once."""

    def __init__(self, svgs: Mapping[str, str], shown: Mapping[str, int]) -> None:
        self.kinds = {name: "own" if OWN_PAPER.search(svg) else "plot" for name, svg in svgs.items()}
        small = {name: _smaller(svg) for name, svg in svgs.items()}
        self.plain = {name: svg if self.kinds[name] == "own" else _in_scheme(svg) for name, svg in small.items()}
        looks = Counter(look for svg in self.plain.values() for look in STYLE.findall(svg))
        self.looks = {look: f"q{n}" for n, look in enumerate(sorted(each for each in looks if looks[each] > FEW))}
        counts = Counter(shape for svg in self.plain.values() for shape in set(SHAPE.findall(svg)))
        often = sorted(shape for shape, count in counts.items() if count > 1)
        self.common = {shape: f"s{number}" for number, shape in enumerate(often)}
        self.names = {name: f"p{number}" for number, name in enumerate(sorted(svgs))}
        self.twice = {name for name in svgs if shown.get(name, 0) > 1}

    def shared(self) -> str:
        """What is in the file once and shown often: shapes, and whole pictures."""
        paths = "".join(f'<path id="{name}"{how}/>' for (_, how), name in self.common.items())
        whole = "".join(map(self._symbol, sorted(self.twice)))
        rules = "".join(f".{name}{{{look}}}" for look, name in self.looks.items())
        inside = f"<style>{rules}</style><defs>{self._classed(paths)}</defs>{whole}"
        return f'<svg width="0" height="0" aria-hidden="true" class="shared">{inside}</svg>'

    def figure(self, name: str, words: str) -> str:
        """The inside of a figure: the picture, named by its caption, and the caption. Raises ValueError."""
        if name not in self.plain:
            raise ValueError(f"no picture {name!r}")
        attributes = f'class="{self.kinds[name]}" role="img" aria-label="{escape(words)}"'
        svg = self._inlined(name).replace("<svg", f"<svg {attributes}", 1)
        if name in self.twice:
            svg = f'{svg[: svg.index(">")].rstrip("/")}><use href="#{self.names[name]}"/></svg>'
        return f"{svg}<figcaption>{escape(words)}</figcaption>"

    def _symbol(self, name: str) -> str:
        svg = self._inlined(name)
        box = re.search(r'viewBox="[^"]*"', svg)
        inside = svg[svg.index(">") + 1 : svg.rindex("</svg>")] if "</svg>" in svg else ""
        return f'<symbol id="{self.names[name]}" {box[0] if box else ""}>{inside}</symbol>'

    def _inlined(self, name: str) -> str:
        shapes = {shape[0]: self.common[shape] for shape in SHAPE.findall(self.plain[name]) if shape in self.common}
        return self._classed(inlined_svg(self.plain[name], self.names[name], shapes))

    def _classed(self, svg: str) -> str:
        """Looks that many shapes have, by their names."""
        return STYLE.sub(lambda at: f' class="{self.looks[at[1]]}"' if at[1] in self.looks else at[0], svg)


def inlined_svg(svg: str, prefix: str, common: Mapping[str, str]) -> str:
    """An SVG element whose ids begin with ``prefix``, so that two pictures never share one, but for ``common`` shapes,
    which are not in it. Raises ValueError for a picture that asks for another file.
    """
    asked = set(re.findall(r'href="#([^"]+)"', svg)) | set(re.findall(r"url\(#([^)]+)\)", svg))
    body = SHAPE.sub(lambda found: "" if found[1] in common else found[0], svg)
    body = re.sub(r' id="([^"]+)"', lambda found: f' id="{prefix}-{found[1]}"' if found[1] in asked else "", body)
    body = re.sub(r'xlink:href="#([^"]+)"', r'href="#\1"', body)
    body = re.sub(r'href="#([^"]+)"', lambda found: f'href="#{common.get(found[1], f"{prefix}-{found[1]}")}"', body)
    body = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", body)
    foreign = re.search(r'(?:href|src)="(?!#|data:)([^"]{0,40})|url\((?!#|data:)([^)]{0,40})', body)
    if foreign:
        raise ValueError(f"a picture asks for {foreign[1] or foreign[2]!r}")
    body = re.sub(r"<defs>\s*</defs>\s*", "", body)
    while (shorter := re.sub(r"<g>\s*</g>\s*", "", body)) != body:
        body = shorter
    return body


def _smaller(svg: str) -> str:
    """Without what HTML has no use for, and with coordinates of two decimals."""
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->|<style[^>]*>[^<]*</style>", _style_of_its_own, body, flags=re.S)
    body = re.sub(r'\b(d|x|y|width|height|points)="([^"]*)"', lambda at: f'{at[1]}="{_coordinates(at[2])}"', body)
    body = re.sub(r"translate\(([^)]*)\)", lambda at: f"translate({_rounded(at[1])})", body)
    body = re.sub(r'style="([^"]*)"', lambda at: f'style="{at[1].replace("; ", ";").replace(": ", ":")}"', body)
    return "\n".join(line.strip() for line in body.splitlines() if line.strip())


def _style_of_its_own(match: re.Match[str]) -> str:
    return match[0] if match[0].startswith("<style") and EVERYWHERE not in match[0] else ""


def _coordinates(text: str) -> str:
    return re.sub(r"\s*([A-Za-z])\s*", r"\1", _rounded(" ".join(text.split())))


def _rounded(text: str) -> str:
    return re.sub(r"-?\d+\.\d{3,}", lambda at: f"{float(at[0]):.{DECIMALS}f}".rstrip("0").rstrip("."), text)


def _in_scheme(svg: str) -> str:
    for colour, name in SCHEME.items():
        svg = re.sub(colour, name, svg)
    return svg
