# Who packs: DEBFULLNAME and DEBEMAIL, as Debian's own tools take them. Read by cpack, and where the changelog is installed.
if(NOT "$ENV{DEBEMAIL}" STREQUAL "")
  set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
elseif(DEFINED CPACK_GENERATOR)
  message(FATAL_ERROR "set DEBFULLNAME and DEBEMAIL: a package names whoever packs it")
else()
  set(CPACK_PACKAGE_CONTACT "installed by hand <>")
endif()
