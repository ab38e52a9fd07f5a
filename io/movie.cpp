#include "io/movie.hpp"

#include <fmt/format.h>
#include <vtkNew.h>
#include <vtkOggTheoraWriter.h>
#include <vtkPNGReader.h>

#include <stdexcept>

namespace hourglass {

void write_movie(const std::vector<std::filesystem::path>& pngs, const std::filesystem::path& path,
                 int frames_per_second) {
  const std::filesystem::path fresh = path.string() + ".new";
  vtkNew<vtkPNGReader> reader;
  vtkNew<vtkOggTheoraWriter> writer;
  writer->SetInputConnection(reader->GetOutputPort());
  writer->SetFileName(fresh.c_str());
  writer->SetRate(frames_per_second);
  writer->SetQuality(2);
  const auto check = [&] {
    if (!writer->GetError()) return;
    std::filesystem::remove(fresh);
    throw std::runtime_error(fmt::format("{}: the video could not be written", path.string()));
  };
  for (std::size_t k = 0; k < pngs.size(); ++k) {
    reader->SetFileName(pngs[k].c_str());
    reader->Update();
    if (k == 0) writer->Start();
    check();
    writer->Write();
    check();
  }
  writer->End();
  check();
  std::filesystem::rename(fresh, path);
}

}  // namespace hourglass
