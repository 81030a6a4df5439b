"""How the page looks, on screen and printed: one column of text, figures a little wider, system fonts."""

from __future__ import annotations

CSS = """
:root {
  --ink: #1b1b1b; --soft: #5a5a5a; --line: #d9d6cf; --paper: #ffffff; --tint: #f5f3ec; --link: #14507d;
  --agrees: #00694d; --part: #8a5a00; --differs: #a63c00; --none: #5a5a5a;
  --serif: Charter, "Bitstream Charter", "Iowan Old Style", "Palatino Linotype", Palatino, Georgia,
    "Liberation Serif", "DejaVu Serif", serif;
  --sans: system-ui, "Segoe UI", "Helvetica Neue", "Liberation Sans", "DejaVu Sans", sans-serif;
}
* { box-sizing: border-box; }
html { scroll-behavior: smooth; -webkit-text-size-adjust: 100%; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 1.06rem/1.55 var(--serif); }
a { color: var(--link); text-decoration-thickness: 1px; text-underline-offset: 2px; }
.skip { position: absolute; left: -100vw; }
.skip:focus { left: 1rem; top: .5rem; background: #fff; padding: .3rem .6rem; }
.page { display: grid; grid-template-columns: 15rem minmax(0, 56rem); gap: 0 3rem; max-width: 78rem;
  margin: 0 auto;
  padding: 0 1.5rem 4rem; }
header, main, footer { grid-column: 2; }
nav { grid-column: 1; grid-row: 1 / span 3; font: .86rem/1.35 var(--sans); }
nav .stay { position: sticky; top: 0; max-height: 100vh; overflow-y: auto; padding: 2.6rem 0 2rem; }
nav summary { display: none; }
nav h2 { font: 600 .74rem/1.3 var(--sans); letter-spacing: .06em; text-transform: uppercase;
  color: var(--soft);
  margin: 1.1rem 0 .4rem; border: 0; padding: 0; }
nav ol { list-style: none; margin: 0; padding: 0; }
nav li { margin: .28rem 0; }
nav a { color: var(--ink); text-decoration: none; }
nav a:hover { color: var(--link); text-decoration: underline; }
header { padding-top: 2.4rem; }
h1 { font-size: 2.1rem; line-height: 1.18; font-weight: 600; margin: 0 0 .5rem; letter-spacing: -.01em; }
h2 { font-size: 1.42rem; line-height: 1.25; font-weight: 600; margin: 3rem 0 .6rem; padding-top: 1rem;
  border-top: 1px solid var(--line); scroll-margin-top: .5rem; }
h3 { font-size: 1.12rem; line-height: 1.3; font-weight: 600; margin: 1.7rem 0 .5rem;
  scroll-margin-top: .5rem; }
p, ul, dl { max-width: 43rem; margin: .6rem 0; }
li { margin: .25rem 0; }
.lead { font-size: 1.14rem; }
.facts, .made { color: var(--soft); font: .86rem/1.5 var(--sans); }
.claim { border-left: 3px solid var(--line); padding: .1rem 0 .1rem .9rem; font-style: italic; }
.notes, .faults { font: .9rem/1.45 var(--sans); background: var(--tint); border-left: 3px solid var(--part);
  padding: .6rem 1rem .6rem 2rem; max-width: 43rem; margin: 1rem 0; }
.faults { border-color: var(--differs); }
code { font: .88em/1.4 ui-monospace, "DejaVu Sans Mono", "Liberation Mono", Menlo, Consolas, monospace;
  overflow-wrap: break-word; }
sub, sup { font-size: .72em; line-height: 0; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font: .86rem/1.35 var(--sans);
  font-variant-numeric: tabular-nums lining-nums; }
.table { margin: 1.3rem 0; }
.caption { font: .93rem/1.4 var(--serif); margin: 0 0 .45rem; }
tbody th code { white-space: nowrap; }
.values { color: var(--soft); font: .86em/1.4 var(--sans); }
th, td { padding: .3rem .75rem .3rem 0; text-align: left; vertical-align: top; font-weight: 400; }
th:last-child, td:last-child { padding-right: 0; }
.n { text-align: right; white-space: nowrap; }
thead th { border-top: 1.5px solid var(--ink); border-bottom: 1px solid var(--ink); vertical-align: bottom;
  font-weight: 600; }
thead th.n { white-space: normal; }
tbody tr:last-child > * { border-bottom: 1.5px solid var(--ink); }
tbody tr + tr > * { border-top: 1px solid #eceae3; }
.points { width: 100%; min-width: 44rem; }
.points td.says { min-width: 13rem; }
.points .why { display: block; color: var(--soft); font-size: .95em; margin-top: .15rem; }
.points th { white-space: nowrap; }
.verdict { font-weight: 600; white-space: nowrap; }
.verdict::before { content: ""; display: inline-block; width: .62em; height: .62em;
  border: 1.5px solid currentColor;
  border-radius: 50%; margin-right: .42em; }
.agrees { color: var(--agrees); } .agrees::before { background: currentColor; }
.in-part { color: var(--part); } .in-part::before {
  background: linear-gradient(90deg, currentColor 50%, #fff 50%); }
.differs { color: var(--differs); } .differs::before { background: #fff; }
.fitted, .not-printed, .not-run, .not-stored { color: var(--none); }
.fitted::before, .not-printed::before, .not-run::before, .not-stored::before { border-radius: 0; height: 0;
  border-width: 0 0 1.5px; vertical-align: .28em; }
.with-letter { list-style: none; padding: 0; }
.with-letter li { padding-left: 0; margin: .45rem 0; }
.study { border-top: 1px solid var(--line); margin-top: 2.6rem; padding-top: .2rem; }
h2 + .study { border-top: 0; margin-top: 0; }
h3 + .claim { margin-top: .4rem; }
h4 { font-size: 1rem; margin: 1.5rem 0 .3rem; break-after: avoid; }
figure { margin: 1.5rem 0; }
.film summary { font: .86rem var(--sans); color: var(--soft); cursor: pointer; }
.film { margin: 1.5rem 0; }
.film figure { margin: .5rem 0 0; }
.gallery {
  display: grid; gap: .6rem 1rem; grid-template-columns: repeat(auto-fill, minmax(min(22rem, 100%), 1fr));
}
.gallery figcaption { grid-column: 1 / -1; }
figure img { display: block; max-width: 100%; height: auto; background: #fff; }
button.zoom { display: block; padding: 0; border: 0; background: none; cursor: zoom-in; max-width: 100%; }
button.zoom:focus-visible, .wide:focus-visible { outline: 2px solid var(--link); outline-offset: 3px; }
figcaption { font: .93rem/1.45 var(--serif); color: var(--ink); max-width: 43rem; margin-top: .5rem; }
figcaption a, .files a { font: .82rem var(--sans); }
.files { font: .84rem/1.6 var(--sans); color: var(--soft); max-width: none; }
.turn { margin: 1.2rem 0; }
.turn button, dialog button { font: .84rem var(--sans); padding: .3rem .7rem; border: 1px solid #a9a69d;
  border-radius: 3px;
  background: #fff; color: var(--ink); cursor: pointer; margin: 0 .3rem .3rem 0; }
.turn button[aria-pressed="true"] { background: var(--ink); color: #fff; }
.turn iframe { display: block; width: 100%; height: 26rem; border: 1px solid var(--line); background: #fff; }
dialog { width: 100vw; height: 100vh; max-width: none; max-height: none; border: 0; padding: 0; margin: 0;
  background: #fff; color: var(--ink); }
dialog[open] { display: flex; flex-direction: column; }
dialog::backdrop { background: #000a; }
dialog .bar { display: flex; gap: .3rem; align-items: center; padding: .5rem .8rem .2rem;
  border-bottom: 1px solid var(--line); }
dialog .bar p { flex: 1; margin: 0 0 .3rem; max-width: none; font: .86rem/1.35 var(--sans);
  color: var(--soft);
  overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
dialog .stage { flex: 1; overflow: auto; display: flex; cursor: grab; }
dialog .stage img { margin: auto; flex: none; display: block; }
footer { color: var(--soft); font: .84rem/1.5 var(--sans); margin-top: 3rem;
  border-top: 1px solid var(--line);
  padding-top: .8rem; }
@media (max-width: 62rem) {
  .page { display: block; padding: 0 1rem 3rem; }
  nav .stay { position: static; max-height: none; padding: 0; }
  nav summary { display: block; font-weight: 600; cursor: pointer; }
  nav summary::after { content: " \\25BE"; }
  nav { border-bottom: 1px solid var(--line); margin-bottom: 1rem; padding: .8rem 0; }
  nav h2 { break-after: avoid; }
  header { padding-top: 1.2rem; }
}
@media (max-width: 34rem) {
  body { font-size: 1rem; }
  h1 { font-size: 1.65rem; }
  h2 { font-size: 1.25rem; }
}
@media (prefers-reduced-motion: reduce) { html { scroll-behavior: auto; } }
@page { size: A4; margin: 17mm 16mm 18mm; }
@media print {
  html { font-size: 8.6pt; }
  body { background: #fff; font-size: 1.08rem; }
  .page { display: block; max-width: none; padding: 0; }
  nav, .skip, .turn, .film, dialog { display: none !important; }
  header { padding-top: 0; }
  a { color: inherit; text-decoration: none; }
  p, ul, dl, figcaption, .notes, .faults { max-width: none; }
  h2, h3, .caption { break-after: avoid; }
  h2 { margin-top: 1.6rem; }
  figure, tr, .claim, li, .caption { break-inside: avoid; }
  figure img { max-width: 100%; max-height: 104mm; object-fit: contain; object-position: left; }
  figure img.tall { max-height: 200mm; }
  figcaption a, .files { display: none; }
  .claim { break-after: avoid; }
  .wide { overflow: visible; }
  .points { min-width: 0; }
  .points th { white-space: normal; }
  .points td.says { min-width: 0; }
  table { font-size: .8rem; max-width: 100%; }
  thead { display: table-header-group; }
  th, td { padding-right: .5rem; }
  .notes, .faults { background: none; }
  .verdict::before { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .made { display: none; }
}
"""
