# cmake -DVIEWER=folder -DSCRIPTS="file file ..." -DOUT=file.cpp -P embed.cmake: page.html, page.css and the scripts (as one) of the
# folder as strings, with the SHA-256 of the latter two, by which the page's content policy knows them.
file(READ "${VIEWER}/page.html" html)
file(READ "${VIEWER}/page.css" css)
separate_arguments(SCRIPTS)
set(script "")
foreach(name ${SCRIPTS})
  file(READ "${VIEWER}/${name}" part)
  string(APPEND script "${part}")
endforeach()
string(SHA256 css_hash "${css}")
string(SHA256 script_hash "${script}")
file(WRITE "${OUT}" "// Made by pipeline/page/embed.cmake.
#include \"pipeline/page/assets.h\"

namespace rfsmooth::pipeline {

const std::string_view kPageHtml = R\"rfsmooth(${html})rfsmooth\";
const std::string_view kPageCss = R\"rfsmooth(${css})rfsmooth\";
const std::string_view kPageCssHash = \"${css_hash}\";
const std::string_view kPageScript = R\"rfsmooth(${script})rfsmooth\";
const std::string_view kPageScriptHash = \"${script_hash}\";

}  // namespace rfsmooth::pipeline
")
