#include <system_error>

#include "core/file.h"
#include "core/file_stream.h"
#include "intaglio/report.h"
#include "report/inspect_page.h"
#include "report/report.h"
#include "session/api.h"
#include "surface/inspect.h"

namespace intaglio {

Result<void> save_report(const Recording& recording, const std::filesystem::path& html,
                         const ReportOptions& options) {
  OutputFiles files;
  auto page = FileStream::create(files, html);
  if (!page) return tl::unexpected(page.error());
  const auto digest = report::digest_of(recording.impl().recording);
  const std::filesystem::path folder = html.has_parent_path() ? html.parent_path() : ".";
  std::error_code error;
  const report::PageVideo video{options.video,
                                std::filesystem::proximate(options.video, folder, error).string()};
  auto written = report::write_report(*digest, video, [&](std::string_view text) { page->write(text); });
  if (!written) return written;
  if (auto finished = page->finish(); !finished) return finished;
  return files.commit();
}

Result<void> save_texture_page(const std::filesystem::path& texture, const std::filesystem::path& html) {
  const auto found = surface::inspect(texture, {});
  if (!found) return tl::unexpected(found.error());
  return write_file(html, report::inspection_html(*found, texture.filename().string()));
}

Result<std::string> texture_json(const std::filesystem::path& texture) {
  return surface::inspect(texture, {}).map([](const surface::Inspection& found) {
    return report::inspection_json(found);
  });
}

}  // namespace intaglio
