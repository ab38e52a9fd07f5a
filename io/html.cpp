#include "io/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace hourglass {
namespace {

// Colours are those of the charts (io/chart.hpp), lighter on a dark page.
constexpr const char* style = R"css(
:root{color-scheme:light dark;--page:#fff;--ink:#1d2229;--soft:#5b6570;--line:#d9dee4;--card:#f5f7f9;--link:#0b5cad;
--good:#1a7f4b;--bad:#b3261e;--wait:#8a5a00;
--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#cc79a7;--c4:#e69f00;--c5:#56b4e9;--c6:#282828;--grey:#b2b2b2}
@media(prefers-color-scheme:dark){:root{--page:#14171b;--ink:#e6e9ed;--soft:#a3adb8;--line:#343b43;--card:#1d2127;--link:#7db8f5;
--good:#5fcf95;--bad:#ff8a80;--wait:#f0c060;
--c0:#4ba3e3;--c1:#ff8b3d;--c2:#2cc79b;--c3:#e59cc5;--c4:#f0b53c;--c5:#8fd0f7;--c6:#d8d8d8;--grey:#6d757d}}
*{box-sizing:border-box}
[hidden]{display:none!important}
html{-webkit-text-size-adjust:100%}
body{margin:0 auto;padding:1.5rem 1rem 4rem;max-width:76rem;background:var(--page);color:var(--ink);
font:16px/1.5 system-ui,"Segoe UI",Roboto,"Helvetica Neue",Arial,"DejaVu Sans",sans-serif;overflow-wrap:break-word}
h1{font-size:1.7rem;line-height:1.2;margin:0 0 .4rem}
h2{font-size:1.25rem;margin:2.2rem 0 .7rem;padding-top:.5rem;border-top:1px solid var(--line)}
h3{font-size:1.05rem;margin:1.4rem 0 .5rem}
p{margin:.4rem 0;max-width:48rem}
a{color:var(--link)}
.soft{color:var(--soft)}
.status{display:flex;flex-wrap:wrap;gap:.3rem .7rem;align-items:baseline;margin:.8rem 0;padding:.6rem .8rem;border:1px solid;
border-left-width:.4rem;border-radius:.3rem;max-width:none}
.status b{text-transform:uppercase;letter-spacing:.04em;font-size:.9rem}
.good{color:var(--good)}.bad{color:var(--bad)}.wait{color:var(--wait)}
.status span{color:var(--ink)}
.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,10.2rem),1fr));gap:.7rem;margin:1rem 0;padding:0}
.cards div{background:var(--card);border-radius:.4rem;padding:.6rem .8rem}
.cards dt{color:var(--soft);font-size:.88rem}
.cards dd{margin:0;font-size:1.2rem;font-variant-numeric:tabular-nums}
.cards small{font-size:.85rem;color:var(--soft)}
.scroll{overflow-x:auto;max-width:100%;margin:.6rem 0}
table{border-collapse:collapse;font-size:.93rem;font-variant-numeric:tabular-nums}
th,td{text-align:left;vertical-align:top;padding:.3rem .8rem .3rem 0;border-bottom:1px solid var(--line)}
thead th{color:var(--soft);font-weight:600;white-space:nowrap}
tbody th{font-weight:600}
.wide th,.wide td{white-space:nowrap}
.wide td.long{white-space:normal;min-width:18rem}
.pairs td{overflow-wrap:anywhere}
@media(max-width:40rem){.wide tbody th{white-space:normal;min-width:8rem}.pairs tr,.pairs th,.pairs td{display:block;padding-right:0}.pairs th{border:0;padding-bottom:0}}
td .bar{display:inline-block;height:.6em;background:var(--c0);border-radius:.1em;min-width:1px}
pre{background:var(--card);padding:.8rem;border-radius:.4rem;overflow-x:auto;font-size:.85rem;line-height:1.4}
code,pre{font-family:ui-monospace,"SF Mono",Menlo,Consolas,"DejaVu Sans Mono",monospace}
details{margin:.6rem 0}
summary{cursor:pointer;color:var(--link)}
.charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,27rem),1fr));gap:1.2rem 1.6rem}
figure{margin:0;min-width:0}
figcaption{font-weight:600;margin-bottom:.2rem}
.chart{position:relative}
.chart>svg{display:block;width:100%;height:auto;max-width:44rem;touch-action:pan-y}
.chart text{fill:var(--ink);font-size:15px}
.grid{stroke:var(--line);fill:none}.axis,.mark{stroke:var(--soft);fill:none;stroke-width:1.3}
.line{fill:none;stroke-width:2.2;stroke-linejoin:round}.thin{stroke-width:1.4}.dash{stroke-dasharray:7 5}
.band{opacity:.25;stroke:none}
.here{fill:var(--page);stroke:var(--ink);stroke-width:2}
.c0{--c:var(--c0)}.c1{--c:var(--c1)}.c2{--c:var(--c2)}.c3{--c:var(--c3)}.c4{--c:var(--c4)}.c5{--c:var(--c5)}.c6{--c:var(--c6)}
.chart .grey{--c:var(--grey)}
.line{stroke:var(--c)}.dot,.band{fill:var(--c)}
.legend{display:flex;flex-wrap:wrap;gap:.1rem 1rem;list-style:none;margin:0 0 .2rem;padding:0;font-size:.88rem}
.legend svg{width:2.1rem;height:.9rem;margin-right:.3rem;vertical-align:-.1rem}
.tip{position:absolute;pointer-events:none;background:var(--card);color:var(--ink);border:1px solid var(--line);border-radius:.3rem;
padding:.2rem .5rem;font-size:.82rem;max-width:16rem;z-index:2}
.viewer{max-width:46rem}
.viewer img{display:block;width:100%;height:auto;background:#fff;border-radius:.3rem}
.controls{display:flex;flex-wrap:wrap;gap:.5rem;align-items:center;margin:.5rem 0}
.controls input{flex:1 1 12rem;min-width:8rem;accent-color:var(--c0)}
.controls output{min-width:9.5rem;font-variant-numeric:tabular-nums}
button{font:inherit;color:var(--ink);background:var(--card);border:1px solid var(--line);border-radius:.3rem;padding:.25rem .7rem;
min-height:2.2rem;cursor:pointer}
button[aria-pressed=true]{border-color:var(--c0);box-shadow:inset 0 -3px 0 var(--c0)}
:focus-visible{outline:2px solid var(--link);outline-offset:2px}
.thumbs{display:grid;grid-template-columns:repeat(auto-fill,minmax(15rem,1fr));gap:1rem}
.thumbs img{width:100%;height:auto;background:#fff;border-radius:.3rem}
@media print{:root{color-scheme:light;--page:#fff;--ink:#000;--soft:#444;--line:#bbb;--card:#f2f2f2;--link:#000}
body{max-width:none;padding:0;font-size:10.5pt}.controls,.copy,.tip{display:none}
figure,.cards div,tr,.viewer{break-inside:avoid}h2,h3{break-after:avoid}
.viewer{max-width:13cm}.scroll{overflow:visible}pre{white-space:pre-wrap}.charts{grid-template-columns:1fr 1fr}}
)css";

constexpr const char* script = R"js(
'use strict';
for (const viewer of document.querySelectorAll('.viewer')) {
  const strips = [...viewer.querySelectorAll('.strip')];
  const slider = viewer.querySelector('input'), told = viewer.querySelector('output'), play = viewer.querySelector('.play');
  let strip = 0, timer = 0;
  const show = () => {
    strips.forEach((s, k) => { s.hidden = k !== strip; });
    const images = [...strips[strip].children];
    slider.max = images.length - 1;
    images.forEach((image, k) => { image.hidden = k !== +slider.value; });
    told.textContent = images[+slider.value].dataset.caption;
    slider.setAttribute('aria-valuetext', told.textContent);
    viewer.querySelectorAll('.field').forEach((b, k) => b.setAttribute('aria-pressed', k === strip));
  };
  const stop = () => {
    clearInterval(timer); timer = 0;
    if (play) { play.textContent = 'Play'; }
  };
  const step = by => { slider.value = +slider.value + by; show(); };
  slider.addEventListener('input', () => { stop(); show(); });
  viewer.querySelectorAll('.field').forEach((button, k) => button.addEventListener('click', () => {
    const share = slider.value / Math.max(1, slider.max);
    strip = k;
    slider.max = strips[k].children.length - 1;
    slider.value = Math.round(share * slider.max);
    show();
  }));
  viewer.querySelector('.back')?.addEventListener('click', () => { stop(); step(-1); });
  viewer.querySelector('.on')?.addEventListener('click', () => { stop(); step(1); });
  play?.addEventListener('click', () => {
    if (timer) { stop(); return; }
    if (slider.value === slider.max) { slider.value = 0; show(); }
    play.textContent = 'Pause';
    timer = setInterval(() => { step(1); if (slider.value === slider.max) { stop(); } }, 250);
  });
  show();
}
for (const figure of document.querySelectorAll('.chart')) {
  const data = JSON.parse(figure.querySelector('script').textContent);
  const svg = figure.querySelector(':scope > svg'), here = svg.querySelector('.here');
  const tip = document.createElement('div');
  tip.className = 'tip'; tip.hidden = true;
  figure.append(tip);
  const split = title => { const m = /^(.*?)\s*\[(.*)\]$/.exec(title); return m ? [m[1], ' ' + m[2]] : [title, '']; };
  const [xName, xUnit] = split(data.x), [yName, yUnit] = split(data.y);
  const leave = () => { tip.hidden = true; here.setAttribute('visibility', 'hidden'); };
  svg.addEventListener('pointermove', event => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    let best = null, least = 60 * 60;
    for (const series of data.series) for (const p of series.points) {
      const d = 4 * (p[0] - at.x) ** 2 + (p[1] - at.y) ** 2;
      if (d < least) { least = d; best = [series.name, p]; }
    }
    if (!best) { leave(); return; }
    const [name, p] = best;
    here.setAttribute('cx', p[0]); here.setAttribute('cy', p[1]); here.setAttribute('visibility', 'visible');
    tip.textContent = (name ? name + ': ' : '') + yName + ' ' + p[3] + yUnit + ' at ' + xName + ' ' + p[2] + xUnit;
    tip.hidden = false;
    const box = figure.getBoundingClientRect(), on = svg.getBoundingClientRect(), scale = on.width / 560;
    const x = on.left - box.left + p[0] * scale, y = on.top - box.top + p[1] * scale;
    tip.style.left = Math.max(0, Math.min(x + 12, box.width - tip.offsetWidth)) + 'px';
    tip.style.top = Math.max(0, y - tip.offsetHeight - 12) + 'px';
  });
  svg.addEventListener('pointerleave', leave);
}
const unfold = () => {
  const target = document.getElementById(location.hash.slice(1));
  if (target && target.tagName === 'DETAILS') { target.open = true; }
};
addEventListener('hashchange', unfold);
unfold();
for (const button of document.querySelectorAll('.copy')) {
  button.hidden = !navigator.clipboard;
  button.addEventListener('click', async () => {
    await navigator.clipboard.writeText(button.parentElement.querySelector('pre').textContent);
    button.textContent = 'Copied';
  });
}
)js";

}  // namespace

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t group = 0;
    for (std::size_t m = 0; m < 3; ++m)
      group = group << 8 | (m < there ? static_cast<unsigned char>(bytes[k + m]) : 0u);
    for (std::size_t m = 0; m < 4; ++m) out += m <= there ? letters[group >> (18 - 6 * m) & 63] : '=';
  }
  return out;
}

std::string html_page(const std::string& title, const std::string& body) {
  // The policy lets nothing in from outside, whatever a name in a scene may try.
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n{}<script>{}</script>\n</body>\n</html>\n",
      html_text(title), style, body, script);
}

std::string html_image(std::string_view png, const std::string& alt, const std::string& more) {
  return fmt::format("<img {}alt=\"{}\" src=\"data:image/png;base64,{}\">", more, html_text(alt),
                     base64(png));
}

std::string html_pairs(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string out = "<table class=\"pairs\">\n";
  for (const auto& [name, what] : rows)
    out += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", html_text(name), html_text(what));
  return out + "</table>\n";
}

std::string html_table(const std::vector<std::vector<std::string>>& rows) {
  constexpr std::size_t is_long = 60;
  std::string out =
      "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"table\"><table "
      "class=\"wide\">\n<thead><tr>";
  for (const std::string& cell : rows.at(0)) out += "<th scope=\"col\">" + cell + "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (std::size_t k = 1; k < rows.size(); ++k) {
    out += "<tr>";
    for (std::size_t c = 0; c < rows[k].size(); ++c)
      out += c == 0
                 ? "<th scope=\"row\">" + rows[k][c] + "</th>"
                 : fmt::format("<td{}>{}</td>",
                               rows[k][c].size() > is_long && rows[k][c][0] != '<' ? " class=\"long\"" : "",
                               rows[k][c]);
    out += "</tr>\n";
  }
  return out + "</tbody>\n</table></div>\n";
}

std::string html_viewer(const std::vector<Filmstrip>& strips) {
  if (strips.empty()) return {};
  std::size_t most = 0;
  std::string fields, pictures;
  for (const Filmstrip& strip : strips) {
    const bool first = &strip == &strips.front();
    most = std::max(most, strip.pngs.size());
    fields += fmt::format("<button type=\"button\" class=\"field\" aria-pressed=\"{}\">{}</button>\n", first,
                          html_text(strip.name));
    pictures += fmt::format("<div class=\"strip\"{}>\n", first ? "" : " hidden");
    for (std::size_t k = 0; k < strip.pngs.size(); ++k)
      pictures += html_image(strip.pngs[k], strip.name + ", " + strip.captions[k],
                             fmt::format("{}data-caption=\"{}\" ", k + 1 < strip.pngs.size() ? "hidden " : "",
                                         html_text(strip.captions[k]))) +
                  '\n';
    pictures += "</div>\n";
  }
  const bool many = most > 1;
  return fmt::format(
      "<div class=\"viewer\">\n<div class=\"controls\" role=\"group\" aria-label=\"field\"{}>\n{}</div>\n"
      "{}<div class=\"controls\"{}>\n<button type=\"button\" class=\"back\" "
      "aria-label=\"earlier\">‹</button>\n"
      "<button type=\"button\" class=\"play\">Play</button>\n"
      "<button type=\"button\" class=\"on\" aria-label=\"later\">›</button>\n"
      "<input type=\"range\" min=\"0\" max=\"{}\" value=\"{}\" aria-label=\"time\">\n</div>\n"
      "<p><output>{}</output></p>\n</div>\n",
      strips.size() > 1 ? "" : " hidden", fields, pictures, many ? "" : " hidden", most - 1, most - 1,
      html_text(strips.front().captions.back()));
}

}  // namespace hourglass
