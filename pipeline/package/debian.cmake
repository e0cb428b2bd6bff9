# Debian packages, one a component: the command; its core library; and, apart from both, what needs PCL, Open3D or CGAL.
#
#   cmake --preset package && cmake --build --preset package && (cd build/package && cpack)   # -> build/package/packages
#
# tests/packages_test.sh installs each of them in a clean system.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the rfsmooth authors <rfsmooth@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENTS_ALL)

file(READ "${PROJECT_SOURCE_DIR}/LICENSE" LICENCE_TEXT)
string(REGEX REPLACE "^.*Copyright[^\n]*\n\n" "" LICENCE_TEXT "${LICENCE_TEXT}")  # title and holder: fields of their own
string(STRIP "${LICENCE_TEXT}" LICENCE_TEXT)
string(REPLACE "\n\n" "\n.\n" LICENCE_TEXT "${LICENCE_TEXT}")
string(REPLACE "\n" "\n " LICENCE_TEXT " ${LICENCE_TEXT}")
string(TIMESTAMP MADE "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where it is set

# debian_package(component COMPONENT NAME name SECTION section [DEPENDS list] [SUGGESTS list] SUMMARY line
# DESCRIPTION text [GPL]): what cpack makes of an installed component. dpkg-shlibdeps adds the shared libraries to DEPENDS. No ';' in the texts.
macro(debian_package component)
  cmake_parse_arguments(P "GPL" "NAME;SECTION;DEPENDS;SUGGESTS;SUMMARY;DESCRIPTION" "" ${ARGN})
  string(TOUPPER ${component} upper)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${P_NAME})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${P_SECTION})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${P_DEPENDS}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_SUGGESTS "${P_SUGGESTS}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${P_SUMMARY}\n${P_DESCRIPTION}")

  set(PACKAGE ${P_NAME})
  set(LICENCE_OF_BINARY "")
  if(P_GPL)
    set(LICENCE_OF_BINARY "Comment:\n It is linked with packages of CGAL that are under the GPL, version 3 or later: so is\n what this package installs. See /usr/share/common-licenses/GPL-3.\n")
  endif()
  set(made "${CMAKE_CURRENT_BINARY_DIR}/${P_NAME}")
  configure_file(copyright.in "${made}/copyright" @ONLY)
  configure_file(changelog.in "${made}/changelog" @ONLY)
  execute_process(COMMAND gzip -9nf "${made}/changelog")
  install(FILES "${made}/copyright" "${made}/changelog.gz" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${P_NAME}"
          COMPONENT ${component})
endmacro()

set(core_dev "librfsmooth-dev (= ${PROJECT_VERSION})")
if(TARGET rfsmooth_command)
  debian_package(command NAME rfsmooth SECTION science
    SUMMARY "takes the noise out of 3-D scans"
    SUGGESTS rfsmooth-reconstruct
    DESCRIPTION "Gives back the same point cloud with the noise gone: every point, every
field, in the same order. Reads and writes PLY, PCD, XYZ and LAS files. The
strength is chosen at every point from the noise that is measured first, so
no setting is needed.")
endif()
debian_package(core NAME librfsmooth-dev SECTION libdevel
  DEPENDS "libeigen3-dev, libtbb-dev, libfmt-dev"
  SUMMARY "takes the noise out of 3-D scans - library"
  DESCRIPTION "Headers, static libraries, a CMake package and a pkg-config file to denoise
point clouds and to smooth meshes in C++ programs.")
if("pcl" IN_LIST components)
  debian_package(pcl NAME librfsmooth-pcl-dev SECTION libdevel
    DEPENDS "${core_dev}, libpcl-dev"
    SUMMARY "takes the noise out of 3-D scans - PCL filter"
    DESCRIPTION "rfsmooth::pcl::Denoise, a pcl::Filter for any point type, and DenoiseSurface,
which gives oriented normals too.")
endif()
if("open3d" IN_LIST components)
  debian_package(open3d NAME librfsmooth-open3d-dev SECTION libdevel
    DEPENDS "${core_dev}, libopen3d-dev"
    SUMMARY "takes the noise out of 3-D scans - Open3D bridge"
    DESCRIPTION "Denoises Open3D's point clouds in place, makes its meshes from rfsmooth's and
hands clouds to its surface reconstruction.")
endif()
if("cgal" IN_LIST components)
  debian_package(cgal NAME librfsmooth-cgal-dev SECTION libdevel GPL
    DEPENDS "${core_dev}, libcgal-dev"
    SUMMARY "takes the noise out of 3-D scans - CGAL part"
    DESCRIPTION "Surface reconstruction by CGAL's advancing front. Programs that link it are
under the GPL.")
endif()
if(TARGET rfsmooth_python)
  get_target_property(minor rfsmooth_python RFSMOOTH_PYTHON_MINOR)
  math(EXPR next "${minor} + 1")
  debian_package(python NAME python3-rfsmooth SECTION python
    DEPENDS "python3 (>= 3.${minor}), python3 (<< 3.${next}), python3-numpy"
    SUGGESTS rfsmooth-reconstruct
    SUMMARY "takes the noise out of 3-D scans - Python 3 module"
    DESCRIPTION "Denoises numpy arrays of points, structured arrays as PDAL and laspy have
them, and clouds of Open3D.")
endif()
if(TARGET rfsmooth_reconstruct)
  set(licence "")
  if(TARGET rfsmooth_cgal)
    set(licence GPL)  # Open3D alone is under MIT
  endif()
  debian_package(reconstruct NAME rfsmooth-reconstruct SECTION science ${licence}
    DEPENDS "rfsmooth (= ${PROJECT_VERSION})"
    SUMMARY "takes the noise out of 3-D scans - surface reconstruction"
    DESCRIPTION "The program behind 'rfsmooth reconstruct': from a noisy point cloud to a
surface mesh.")
endif()
include(CPack)
