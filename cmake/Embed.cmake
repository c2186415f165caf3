# sheaf_embed(<target> <name> <file>...): compiles the files into the target, each as a string_view in namespace
# sheaf::embedded, declared in a header <name>.h: report.css becomes kReportCss.
function(sheaf_embed target name)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  set(declarations "")
  set(definitions "")
  foreach(file IN LISTS ARGN)
    get_filename_component(path ${file} ABSOLUTE)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
    get_filename_component(constant ${path} NAME)
    string(REGEX REPLACE "[^A-Za-z0-9]" ";" words ${constant})
    set(constant k)
    foreach(word IN LISTS words)
      string(SUBSTRING ${word} 0 1 first)
      string(SUBSTRING ${word} 1 -1 rest)
      string(TOUPPER ${first} first)
      string(APPEND constant ${first}${rest})
    endforeach()
    # As bytes: text would have to be free of whatever ends a literal.
    file(READ ${path} bytes HEX)
    string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
    string(APPEND declarations "extern const std::string_view ${constant};\n")
    string(APPEND definitions "static constexpr unsigned char ${constant}Bytes[] = {${bytes}};\n"
                              "const std::string_view ${constant}(reinterpret_cast<const char*>(${constant}Bytes),\n"
                              "                                  sizeof(${constant}Bytes));\n")
  endforeach()
  set(head "#pragma once\n#include <string_view>\nnamespace sheaf::embedded {\n")
  file(CONFIGURE OUTPUT ${folder}/${name}.h CONTENT "${head}${declarations}}\n" @ONLY)
  file(CONFIGURE OUTPUT ${folder}/${name}.cpp CONTENT
       "#include \"${name}.h\"\nnamespace sheaf::embedded {\n${definitions}}\n" @ONLY)
  target_sources(${target} PRIVATE ${folder}/${name}.cpp)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
