# Compiles the type supports of each package as one source, which takes half the time: run.py includes this at the end of
# each package. Those for introspection in C++ cannot be, for they specialise what they have used before.
function(compile_type_supports_as_one)
  get_property(targets DIRECTORY PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    if(target MATCHES "__rosidl_typesupport_(fastrtps_)?(c|cpp)$")
      set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
    endif()
  endforeach()
endfunction()
cmake_language(DEFER CALL compile_type_supports_as_one)
