# Name and address of the packager: DEBFULLNAME and DEBEMAIL, as in Debian's tools. cpack and the installation of the
# changelog include this file.
if(NOT "$ENV{DEBEMAIL}" STREQUAL "")
  set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
elseif(DEFINED CPACK_GENERATOR)
  message(FATAL_ERROR "set DEBFULLNAME and DEBEMAIL: a package names its packager")
else()
  set(CPACK_PACKAGE_CONTACT "installed by hand <>")
endif()
