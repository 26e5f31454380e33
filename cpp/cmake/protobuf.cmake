# Finds protobuf as protobuf::libprotobuf and protobuf::protoc.
#
# Include this in every folder that uses these targets: CMake knows an imported target only in its folder and below.
find_package(protobuf CONFIG QUIET)  # from version 22 on, this also names the libraries of Abseil
if(NOT TARGET protobuf::libprotobuf)
  find_package(Protobuf REQUIRED)
endif()
