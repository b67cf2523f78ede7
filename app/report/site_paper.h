#pragma once

#include "app/report/document.h"
#include "app/site_settings.h"

namespace planlight {

/// The sheets that this site prints on: A4 where its settings say nothing. Throws as `read_site_settings`.
inline PaperSize paper_of_site() {
    return read_site_settings().paper == "Letter" ? PaperSize::letter : PaperSize::a4;
}

}  // namespace planlight
