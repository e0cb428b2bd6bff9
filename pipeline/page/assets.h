/// What a page is made of besides its contents: the files in viewer, put into the program when it is built
/// (embed.cmake).
#pragma once

#include <string_view>

namespace rfsmooth::pipeline {

extern const std::string_view kPageHtml, kPageCss, kPageScript;
/// SHA-256 in hexadecimal digits, by which the page's content policy knows them.
extern const std::string_view kPageCssHash, kPageScriptHash;

}  // namespace rfsmooth::pipeline
