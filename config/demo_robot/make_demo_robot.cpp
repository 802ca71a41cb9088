// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Writes the meshes of the demo arm: make_demo_robot FOLDER
#include "config/demo_robot/links.hpp"
#include "config/demo_robot/write_links.hpp"

int main(int argc, char** argv) {
  using namespace calibrd;
  return demo::write_links(argc, argv,
                           {{"base", demo::base()},
                            {"turret", demo::turret()},
                            {"lower_arm", demo::lower_arm()},
                            {"elbow", demo::elbow()},
                            {"forearm", demo::forearm()},
                            {"wrist", demo::wrist()},
                            {"hand", demo::hand()},
                            {"flange", demo::flange()}});
}
