// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Writes the meshes of the test arm: make_test_arm6 FOLDER
#include "config/demo_robot/write_links.hpp"
#include "tests/robots/arm6_links.hpp"

int main(int argc, char** argv) {
  using namespace calibrd::test;
  return calibrd::demo::write_links(argc, argv,
                                    {{"foot", arm6::foot()},
                                     {"shoulder", arm6::shoulder()},
                                     {"upper_arm", arm6::upper_arm()},
                                     {"elbow", arm6::elbow()},
                                     {"forearm", arm6::forearm()},
                                     {"wrist", arm6::wrist()},
                                     {"tool", arm6::tool()}});
}
