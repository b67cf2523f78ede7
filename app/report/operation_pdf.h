#pragma once

#include <string>

#include "app/report/document.h"
#include "app/report/operation_report.h"

namespace planlight {

/// The report of an operation as PDF (its bytes): what `write_operation_report` shows, in the same order. Throws
/// DeviceError where its font is not installed.
std::string operation_pdf(const OperationFacts& facts, PaperSize paper);

}  // namespace planlight
