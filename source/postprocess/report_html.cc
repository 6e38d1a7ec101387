#include "report_html.h"

#include "records/engineering.h"
#include "visualization/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    const char *const page_style = R"css(
:root{color-scheme:light dark;--back:#f5f6f8;--card:#fff;--ink:#1c2128;
--muted:#5b636e;--line:#dfe3e8;--good:#12734a;--good-back:#e2f4ea;
--bad:#a8281a;--bad-back:#fdeae6;--bar:#8bb8dc}
@media screen and (prefers-color-scheme:dark){:root{--back:#12151a;
--card:#1b1f26;--ink:#e6e9ee;--muted:#a4acb8;--line:#323943;--good:#6fdca6;
--good-back:#15352a;--bad:#ff9d86;--bad-back:#43211b;--bar:#2f5f86}}
*{box-sizing:border-box}
body{margin:0;background:var(--back);color:var(--ink);
font:15px/1.5 system-ui,'Segoe UI',Roboto,Helvetica,Arial,sans-serif}
main{max-width:1240px;margin:0 auto;padding:20px 16px 40px}
h1{font-size:1.6rem;line-height:1.25;margin:0 0 .4rem}
h2{font-size:1.15rem;margin:2rem 0 .6rem}
h3{font-size:1rem;margin:0 0 .5rem}
p{margin:.4rem 0;max-width:75ch}
.muted{color:var(--muted)}
.state{display:inline-block;border-radius:6px;padding:.45rem .8rem;
margin:.5rem 0;font-weight:600;overflow-wrap:anywhere}
.state.open{border:1px solid var(--line)}
.good{color:var(--good)}.bad{color:var(--bad)}
.state.good{background:var(--good-back)}.state.bad{background:var(--bad-back)}
.row{display:grid;gap:14px;align-items:start;
grid-template-columns:repeat(auto-fill,minmax(min(100%,370px),1fr))}
.columns{columns:370px;column-gap:14px}
.columns>.card{break-inside:avoid;margin-bottom:14px}
.card{background:var(--card);border:1px solid var(--line);border-radius:8px;
padding:12px;margin:0;overflow-x:auto}
.card svg{display:block;width:100%;height:auto;max-width:620px;margin:0 auto}
table{border-collapse:collapse;width:100%}
th,td{text-align:left;padding:.28rem .5rem .28rem 0;vertical-align:top;
border-bottom:1px solid var(--line);font-weight:400}
tr:last-child>th,tr:last-child>td{border-bottom:0}
th{color:var(--muted)}thead th{font-size:.85rem}
td.number{text-align:right;white-space:nowrap;
font-variant-numeric:tabular-nums;color:var(--ink)}
tr.sum>th,tr.sum>td{font-weight:600;color:var(--ink);
border-top:1px solid var(--muted)}
tr.group>th{font-size:.85rem;font-weight:600;padding-top:.6rem;border-bottom:0;
color:var(--ink)}
td.remark{color:var(--muted);font-size:.88rem}
td.text{overflow-wrap:anywhere}td.verdict{white-space:nowrap}
.share,.state{print-color-adjust:exact;-webkit-print-color-adjust:exact}
.share{display:block;height:8px;border-radius:2px;background:var(--bar);
min-width:1px;margin-top:.45rem}
td.bar{width:32%;padding-right:0}
details{margin-top:.5rem}summary{cursor:pointer;font-weight:600}
pre{overflow-x:auto;background:var(--card);border:1px solid var(--line);
border-radius:8px;padding:12px;font:12.5px/1.45 ui-monospace,Menlo,Consolas,
'DejaVu Sans Mono',monospace}
a{color:inherit}
@media print{body{background:#fff;font-size:11px}main{padding:0}
.card{break-inside:avoid;border-color:#ccc}
.row{grid-template-columns:repeat(2,1fr)}h2{break-after:avoid}
pre{white-space:pre-wrap}}
)css";
  } // namespace

  std::string count(const double value)
  {
    if (!std::isfinite(value) || value != std::floor(value) ||
        std::abs(value) >= 1e15)
      return engineering(value, "", 4);
    std::string text = fmt::format("{:.0f}", value);
    for (int i = static_cast<int>(text.size()) - 3;
         i > (value < 0. ? 1 : 0) && std::abs(value) >= 1e4; i -= 3)
      text.insert(i, "\u202f");
    return text;
  }

  std::string count(const double n, const std::string &noun)
  {
    return count(n) + ' ' + noun + (n == 1. ? "" : "s");
  }

  std::string readable(std::string key)
  {
    std::replace(key.begin(), key.end(), '_', ' ');
    return key;
  }

  std::string relative(const double value)
  {
    return value == 0. ? "0" : engineering(value, "", 2);
  }

  std::string percent(const double share)
  {
    if (!std::isfinite(share))
      return "n/a";
    // no minus before what is rounded to nothing
    const std::string text = fmt::format("{:.1f} %", 100. * share);
    return text == "-0.0 %" ? "0.0 %" : with_minus(text);
  }

  void Table::add(const std::string &name, const std::string &value,
                  const std::string &remark, const CardVerdict verdict)
  {
    const char *mark = verdict == CardVerdict::good ? "<b class=\"good\">✓</b> "
                       : verdict == CardVerdict::bad ? "<b class=\"bad\">⚠</b> "
                                                     : "";
    rows_ += fmt::format("<tr><th>{}</th><td class=\"number\">{}</td>"
                         "<td class=\"remark\">{}{}</td></tr>\n",
                         escape_markup(name), escape_markup(value), mark,
                         escape_markup(remark));
  }

  void Table::add_judged(const std::string &name, const std::string &value,
                         const std::string &bound, const std::string &verdict,
                         const CardVerdict kind, const std::string &remark)
  {
    const char *mark = kind == CardVerdict::good  ? "<b class=\"good\">✓</b> "
                       : kind == CardVerdict::bad ? "<b class=\"bad\">⚠</b> "
                                                  : "– ";
    rows_ += fmt::format("<tr><th>{}</th><td class=\"number\">{}</td>"
                         "<td class=\"number\">{}</td>"
                         "<td class=\"verdict\">{}{}</td>"
                         "<td class=\"remark\">{}</td></tr>\n",
                         escape_markup(name), escape_markup(value),
                         escape_markup(bound), mark, escape_markup(verdict),
                         escape_markup(remark));
  }

  void Table::add_sum(const std::string &name, const std::string &value)
  {
    rows_ += fmt::format("<tr class=\"sum\"><th>{}</th>"
                         "<td class=\"number\">{}</td><td></td></tr>\n",
                         escape_markup(name), escape_markup(value));
  }

  void Table::add_group(const std::string &name)
  {
    rows_ += "<tr class=\"group\"><th colspan=\"3\">" + escape_markup(name) +
             "</th></tr>\n";
  }

  void Table::add_share(const std::string &name, const std::string &value,
                        const double share)
  {
    rows_ += fmt::format(
        "<tr><th>{}</th><td class=\"number\">{}</td>"
        "<td class=\"number\">{}</td><td class=\"bar\">"
        "<span class=\"share\" style=\"width:{:.1f}%\"></span></td></tr>\n",
        escape_markup(name), escape_markup(value), percent(share),
        std::isfinite(share) ? 100. * std::clamp(share, 0., 1.) : 0.);
  }

  void Table::add_text(const std::string &name, const std::string &text)
  {
    if (!text.empty())
      rows_ += fmt::format("<tr><th>{}</th><td class=\"text\">{}</td></tr>\n",
                           escape_markup(name), escape_markup(text));
  }

  std::string Table::card(const std::string &title) const
  {
    if (rows_.empty())
      return "";
    return "<section class=\"card\"><h3>" + escape_markup(title) +
           "</h3>\n<table>\n" + rows_ + "</table></section>\n";
  }

  std::string section(const std::string &title, const std::string &content)
  {
    return "<h2>" + escape_markup(title) + "</h2>\n" + content;
  }

  std::string columns_of(const std::string &cards)
  {
    return "<div class=\"columns\">\n" + cards + "</div>\n";
  }

  std::string row_of(const std::string &cards)
  {
    return "<div class=\"row\">\n" + cards + "</div>\n";
  }

  std::string paragraphs(const std::string &text)
  {
    std::string html;
    std::size_t begin = 0;
    while (begin < text.size()) {
      const std::size_t end = std::min(text.find("\n\n", begin), text.size());
      if (end > begin)
        html +=
            "<p>" + escape_markup(text.substr(begin, end - begin)) + "</p>\n";
      begin = end + 2;
    }
    return html;
  }

  std::string page(const std::string &title, const std::string &content)
  {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
           "<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, "
           "initial-scale=1\">\n<title>" +
           escape_markup(title) + " - nsfd</title>\n<style>" + page_style +
           svg_style() +
           "@media screen and (prefers-color-scheme:dark){:root{" +
           svg_dark_colours() + "}}</style>\n</head>\n<body>\n<main>\n" +
           content + "</main>\n</body>\n</html>\n";
  }
} // namespace nsfd
