#include "app/commands/pdf_option.h"

#include "app/report/site_paper.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

void pdf_option(CLI::App* command, fs::path& pdf) {
    command->add_option("--pdf", pdf, "Write the page as PDF as well (A4; Letter where the site's settings say so)");
}

bool stands_in(const fs::path& file, const fs::path& folder) {
    std::error_code not_there;
    const auto whole = [&](const fs::path& path) {
        return fs::weakly_canonical(fs::absolute(path, not_there), not_there);
    };
    return whole(file).parent_path() == whole(folder / "in").parent_path();
}

void check_pdf(const fs::path& pdf, const fs::path& made) {
    if (pdf.empty()) return;
    if (pdf.extension() != ".pdf" && pdf.extension() != ".PDF")
        throw InputError(pdf, "is not the name of a PDF", "Let it end in .pdf: `--pdf report.pdf`.");
    pdf_of({"Is there a font?"}, paper_of_site());
    if (made.empty() || !stands_in(pdf, made) || fs::exists(made)) check_can_write(pdf);
}

void write_pdf(const Document& document, const fs::path& pdf, ReadableBy readable_by) {
    if (!pdf.empty()) write_safely(pdf, pdf_of(document, paper_of_site()), readable_by);
}

}  // namespace planlight
