#include "app/report/report_beside.h"

#include "app/report/operation_comparison.h"
#include "app/report/operation_pdf.h"
#include "app/report/operation_report.h"
#include "app/report/site_paper.h"
#include "planning_io/files/safe_write.h"

namespace planlight {

ReportBeside write_report_beside(const std::filesystem::path& recording, const std::function<void()>& go_on) {
    OperationFacts facts = facts_of_operation(recording, go_on);
    compare_moment(facts, recording, go_on);
    ReportBeside report{recording, recording, verdict_of(facts).sentence};
    report.page.replace_extension(".html");
    report.pdf.replace_extension(".pdf");
    write_operation_report(facts, operation_json(facts), report.page);
    write_safely(report.pdf, operation_pdf(facts, paper_of_site()), ReadableBy::owner);
    return report;
}

}  // namespace planlight
