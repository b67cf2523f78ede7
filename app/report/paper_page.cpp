#include "app/report/paper_page.h"

#include <fmt/format.h>

#include "app/report/html_page.h"

namespace planlight {
namespace {

/// A sheet's content is 184 mm wide and at most 250 mm high: what A4 and Letter both hold within margins of 12 mm.
constexpr const char* kStyle = R"(
@page{margin:10mm 12mm 8mm}
*{box-sizing:border-box}
body{margin:0;background:#e9ebee;color:#15181d;font:9.5pt/1.35 Inter,"DejaVu Sans",sans-serif;
overflow-wrap:break-word;-webkit-print-color-adjust:exact;print-color-adjust:exact}
main{width:184mm;margin:0 auto}
.sheet{background:#fff}
@media screen{.sheet{margin:6mm -13mm;padding:12mm 13mm;box-shadow:0 1px 5px #0003}.foot{display:none}}
@media print{body{background:#fff}.sheet+.sheet{break-before:page}.foot{position:fixed;bottom:0;left:0;right:0;
text-align:center;font-size:7.5pt;color:#5b6470}}
h1{font-size:17pt;line-height:1.2;margin:0}
h2{font-size:11pt;margin:3.5mm 0 1mm;break-after:avoid}
p{margin:.8mm 0}.muted{color:#5b6470;font-size:8pt}
table{border-collapse:collapse;width:100%}
td,th{padding:.5mm 2mm .5mm 0;border-bottom:.2mm solid #d5d9df;text-align:left;vertical-align:top}
th{color:#5b6470;font-weight:500;font-size:8pt}tr{break-inside:avoid}
td.name{width:24%;overflow-wrap:anywhere}.plan td{padding:.35mm 2mm .35mm 0}.plan th{font-size:7.5pt;line-height:1.15}
.plan td.words{min-width:19mm}.small{font-size:8pt;line-height:1.25}.plan td.figure,.figure{white-space:nowrap}
.tight td,.tight th{padding-right:1.5mm}.tight td{font-size:9pt}.tight td.name{width:20%}.tight td.risk{min-width:31mm}
.two{display:grid;grid-template-columns:1fr 1fr;gap:0 6mm;align-items:start}
.two table{table-layout:fixed}.two td{overflow-wrap:anywhere}
.two td:first-child{color:#5b6470;width:34%}
.verdict{border:.5mm solid;border-radius:1.5mm;padding:1.5mm 3mm;font-weight:600;margin:2.5mm 0 1.5mm;break-inside:avoid}
.good{color:#14663a}.look{color:#8a5300}.stop{color:#a3121f;font-weight:600}
ul{margin:1mm 0;padding-left:5mm}li{margin:.4mm 0}
.row{display:grid;gap:2mm;margin:1mm 0}
figure{margin:0;break-inside:avoid}
figure img{width:100%;display:block;border:.2mm solid #c3c8d0}
/* A sheet that fits is one page: its pictures share the room that its text leaves. */
@media print{.fit{height:250mm;display:flex;flex-direction:column}.fit>*{flex:none}
.fit>.row{flex:0 1 68mm;min-height:32mm;grid-template-rows:minmax(0,1fr)}
.fit figure{display:flex;flex-direction:column;min-height:0}.fit figure img{flex:1;min-height:0;object-fit:contain}}
figcaption{font-size:7.5pt;line-height:1.25;padding-top:.6mm;color:#353b45}
.key{display:flex;flex-wrap:wrap;gap:0 4mm;margin:.8mm 0;color:#5b6470;font-size:8pt}
.key i{display:inline-block;width:3mm;height:3mm;margin-right:1.5mm;vertical-align:-.4mm}
.scale{display:block;width:100%;max-width:90mm;margin:1mm 0}
.sign{display:grid;grid-template-columns:5fr 3fr 6fr;gap:0 6mm;margin-top:7.5mm;break-inside:avoid}
.sign span{border-top:.25mm solid #15181d;font-size:7.5pt;color:#5b6470;padding-top:.5mm})";

}  // namespace

std::string paper_page(const std::string& title, const std::string& body, const std::string& foot) {
    return fmt::format(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title><style>{}</style></head>"
        "<body><main>{}</main><div class=\"foot\">{}</div></body></html>\n",
        xml_escaped(title), kStyle, body, xml_escaped(foot));
}

}  // namespace planlight
